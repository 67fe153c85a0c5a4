// The files of Unix sockets.
#ifndef LATVOX_SERVER_UNIX_SOCKET_H_
#define LATVOX_SERVER_UNIX_SOCKET_H_

#include <sys/types.h>

#include <ctime>
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

// The socket files that a server has made, which gRPC leaves behind unless it shuts down.
class SocketFiles {
 public:
  // Once the server listens there. Other addresses have no file.
  void Add(const std::string& address);

  // Removes them, but none that another server has made in the place of one.
  void Remove() const;

 private:
  struct File {
    std::string path;
    dev_t device;
    ino_t number;
    timespec made;  // numbers are given again

    static std::optional<File> At(const std::string& path);
  };
  std::vector<File> files_;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_UNIX_SOCKET_H_
