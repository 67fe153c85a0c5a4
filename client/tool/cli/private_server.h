// A latvoxd of the tool's own, for one call.
#ifndef LATVOX_CLIENT_TOOL_CLI_PRIVATE_SERVER_H_
#define LATVOX_CLIENT_TOOL_CLI_PRIVATE_SERVER_H_

#include <sys/types.h>

#include <memory>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/tool/output/atomic_file.h"
#include "latvox/client.h"

namespace latvox::client {

// Listens on a Unix socket in a fresh directory that only this user can enter. The destructor ends the server and
// removes the directory; if this process is killed, the server ends by itself (--exit-with-parent), however early. By
// default it takes half of the memory that latvoxd does otherwise: the rest is for meshes and grids here. It does not
// take over what the environment says of a server for others: LATVOX_CONFIG, addresses, TLS and tokens.
class PrivateServer {
 public:
  // Starts latvoxd and waits until it accepts connections. The program is $LATVOX_LATVOXD, else the latvoxd beside
  // this program, else the one in PATH. Errors: UNAVAILABLE (not found, ended early, does not answer in time);
  // DEADLINE_EXCEEDED, CANCELLED.
  static absl::StatusOr<std::unique_ptr<PrivateServer>> Start(std::optional<int> threads, const CallOptions& options);
  ~PrivateServer();
  PrivateServer(const PrivateServer&) = delete;
  PrivateServer& operator=(const PrivateServer&) = delete;

  std::string address() const;  // "unix:PATH"
  const std::string& program() const { return program_; }

  // Removes the socket and its directory. Connections go on, new ones cannot be made. Once there is one, nothing of
  // this server is left in the file system, not even if this process is killed.
  void RemoveDirectory();

 private:
  PrivateServer() = default;
  absl::Status MakeDirectory();
  absl::Status Spawn(std::optional<int> threads);
  absl::Status AwaitReady(const CallOptions& options);
  std::string SocketPath() const;

  std::string program_, directory_;
  std::optional<TemporaryDirectoryMark> mark_;  // of directory_
  pid_t pid_ = -1;                              // -1: none to end
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_PRIVATE_SERVER_H_
