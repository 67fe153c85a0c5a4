// grpc.health.v1 alone, on an address of its own: for probes without TLS, such as those of Kubernetes.
#ifndef LATVOX_SERVER_LISTEN_HEALTH_SERVER_H_
#define LATVOX_SERVER_LISTEN_HEALTH_SERVER_H_

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "server/base/unix_socket.h"

namespace latvox {

class HealthServer {
 public:
  // Answers SERVING when it returns, in plain text. Errors: UNAVAILABLE naming the address.
  static absl::StatusOr<std::unique_ptr<HealthServer>> Start(const std::string& address);

  virtual ~HealthServer() = default;

  // The given address, with the port that was chosen.
  virtual const std::string& address() const = 0;

  virtual const SocketFiles& socket_files() const = 0;

  // Answers NOT_SERVING from now on.
  virtual void SetNotServing() = 0;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_LISTEN_HEALTH_SERVER_H_
