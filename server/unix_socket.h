// The files of Unix sockets.
#ifndef LATVOX_SERVER_UNIX_SOCKET_H_
#define LATVOX_SERVER_UNIX_SOCKET_H_

#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"

namespace latvox {

// PATH of an address unix:PATH or unix:///PATH.
std::optional<std::string> SocketPathOf(const std::string& address);

// gRPC would take the path over from a server that still listens there. UNAVAILABLE if one does, or if the path is too
// long, or if it is something else than a socket. A socket file without a server behind it is fine.
absl::Status CheckSocketPathIsFree(const std::string& path);

// Removes the socket files among `addresses`, which gRPC leaves behind unless it shuts down.
void RemoveSocketFiles(const std::vector<std::string>& addresses);

}  // namespace latvox

#endif  // LATVOX_SERVER_UNIX_SOCKET_H_
