// Connections of sockets that are open already, for gRPC, which opens its own alone.
#ifndef LATVOX_SERVER_LISTEN_SOCKET_ACCEPTOR_H_
#define LATVOX_SERVER_LISTEN_SOCKET_ACCEPTOR_H_

#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server_builder.h>

#include <memory>
#include <thread>
#include <vector>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "server/base/activated_sockets.h"

namespace latvox {

// A thread that accepts the connections, and a server that has them.
class SocketAcceptor {
 public:
  SocketAcceptor() = default;
  ~SocketAcceptor() { Stop(); }
  SocketAcceptor(const SocketAcceptor&) = delete;
  SocketAcceptor& operator=(const SocketAcceptor&) = delete;

  // Adds a socket to the server that is about to be built. A client that does not acknowledge bytes for
  // `acknowledge_timeout` loses its connection, as it does at ports of gRPC.
  void Add(grpc::ServerBuilder& builder, const ActivatedSocket& socket,
           std::shared_ptr<grpc::ServerCredentials> credentials, absl::Duration acknowledge_timeout);

  // Accepts from now on. Call it once, after the server has started. Errors: UNAVAILABLE: there is no file left.
  absl::Status Start();

  // Accepts no more. Further connections wait in the sockets, for whoever has these next. Call it before the server's
  // shutdown, from which on gRPC would lose connections. Idempotent.
  void Stop();

 private:
  struct Listener {
    ActivatedSocket socket;
    std::unique_ptr<grpc::experimental::ExternalConnectionAcceptor> connections;
  };

  void Run();
  bool AcceptOne(const Listener& listener);
  void LogFailure(const Listener& listener, int error);

  std::vector<Listener> listeners_;
  int stop_ = -1;                                // readable once the thread is to end
  absl::Time next_line_ = absl::InfinitePast();  // of the log; the thread's own
  std::thread thread_;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_LISTEN_SOCKET_ACCEPTOR_H_
