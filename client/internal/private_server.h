// A latvoxd for this program alone.
#ifndef LATVOX_CLIENT_INTERNAL_PRIVATE_SERVER_H_
#define LATVOX_CLIENT_INTERNAL_PRIVATE_SERVER_H_

#include <sys/types.h>

#include <functional>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/internal/process_directory.h"
#include "latvox/call_options.h"
#include "latvox/private_server_options.h"

namespace latvox::client {

// Listens on a Unix socket in a fresh directory that only this user can enter. The destructor ends the server and
// removes the directory. If this process is killed, the server ends by itself (--exit-with-parent), however early.
// The server takes half of the usual memory by default, because this process needs the rest for meshes and grids. It
// ignores variables that are meant for other servers: LATVOX_CONFIG, addresses, TLS and tokens.
class PrivateServer {
 public:
  // Starts latvoxd, which takes some 50 ms to accept connections. Calls `on_directory` with the new directory, so that
  // a program which ends without destructors can remove it. Errors: UNAVAILABLE (not found).
  static absl::StatusOr<std::unique_ptr<PrivateServer>> Start(
      const PrivateServerOptions& options, const std::function<void(const std::string& path)>& on_directory = nullptr);

  // Waits until it accepts connections. Errors: UNAVAILABLE (ended early, does not answer in time); DEADLINE_EXCEEDED;
  // CANCELLED.
  absl::Status AwaitReady(const CallOptions& options);

  ~PrivateServer();
  PrivateServer(const PrivateServer&) = delete;
  PrivateServer& operator=(const PrivateServer&) = delete;

  std::string address() const;  // "unix:PATH"
  const std::string& program() const { return program_; }

  // Removes the socket and its directory. Connections go on, but nobody can open new ones. Call it once connected: then
  // the server leaves nothing in the file system, even if this process is killed.
  void RemoveDirectory();

  // Asks the server to end, and returns at once. The destructor waits for the end. Call it after the last call, before
  // other work: the end takes some 15 ms.
  void End();

 private:
  PrivateServer() = default;
  absl::Status MakeDirectory();
  absl::Status Spawn(const PrivateServerOptions& options);

  std::string program_, socket_path_;
  std::unique_ptr<ProcessDirectory> directory_;
  pid_t pid_ = -1;  // -1: no server to end
  bool ends_ = false;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_PRIVATE_SERVER_H_
