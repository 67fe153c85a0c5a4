// Files of Unix sockets.
#ifndef LATVOX_SERVER_BASE_UNIX_SOCKET_H_
#define LATVOX_SERVER_BASE_UNIX_SOCKET_H_

#include <sys/types.h>

#include <ctime>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"

namespace latvox {

// Returns PATH of an address unix:PATH or unix:///PATH.
std::optional<std::string> SocketPathOf(const std::string& address);

// Returns UNAVAILABLE if a server still listens at the path, because gRPC would take the path from it; or if the path
// is too long, or is not a socket. A socket file without a server is fine.
absl::Status CheckSocketPathIsFree(const std::string& path);

// Returns the address that gRPC listens on in place of `address`: for unix:PATH, a name of this process's own beside
// PATH, if there is room for one. At shutdown, gRPC removes the file with the name that it listens on, even if that
// file is another server's.
std::string ProvisionalAddress(const std::string& address);

// The files of the sockets that a server listens at.
class SocketFiles {
 public:
  // Moves the file of a provisional address into its place, once the server listens there. Does nothing for addresses
  // without a file. Returns UNAVAILABLE if that fails.
  absl::Status MoveIntoPlace(const std::string& address);

  void Add(const SocketFiles& others) { files_.insert(files_.end(), others.files_.begin(), others.files_.end()); }

  // Removes the files, except one that another server has put in its place.
  void Remove() const;

 private:
  struct File {
    std::string path;
    dev_t device;
    ino_t number;
    timespec made;  // because file numbers are reused

    static std::optional<File> At(const std::string& path);
  };
  std::vector<File> files_;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_BASE_UNIX_SOCKET_H_
