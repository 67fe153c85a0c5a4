// The files of Unix sockets.
#ifndef LATVOX_SERVER_BASE_UNIX_SOCKET_H_
#define LATVOX_SERVER_BASE_UNIX_SOCKET_H_

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

// Where gRPC is to listen in the place of an address: of unix:PATH, at a name of this process's own beside PATH, if
// there is room for one. When gRPC shuts down, it removes what has the name that it listens at, whoever's that is.
std::string ProvisionalAddress(const std::string& address);

// The files of the sockets that a server listens at.
class SocketFiles {
 public:
  // Once the server listens at the provisional address: moves its file to where it belongs. Addresses that are no files
  // do nothing. UNAVAILABLE if that fails.
  absl::Status MoveIntoPlace(const std::string& address);

  void Add(const SocketFiles& others) { files_.insert(files_.end(), others.files_.begin(), others.files_.end()); }

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

#endif  // LATVOX_SERVER_BASE_UNIX_SOCKET_H_
