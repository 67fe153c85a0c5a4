#include "server/base/unix_socket.h"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"

namespace latvox {
namespace {

constexpr size_t kLongestPath = sizeof(sockaddr_un::sun_path) - 1;

bool SomebodyListens(const std::string& path) {
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd < 0) return false;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof(address.sun_path) - 1);
  // EAGAIN means that there is a queue, although it is full.
  const bool listens =
      connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0 || errno == EAGAIN;
  close(fd);
  return listens;
}

}  // namespace

std::optional<std::string> SocketPathOf(const std::string& address) {
  constexpr char kScheme[] = "unix:";
  if (!absl::StartsWith(address, kScheme)) return std::nullopt;
  const std::string path = address.substr(std::strlen(kScheme));
  return absl::StartsWith(path, "///") ? path.substr(2) : path;
}

absl::Status CheckSocketPathIsFree(const std::string& path) {
  if (path.empty() || path.size() > kLongestPath) {
    return absl::UnavailableError(absl::StrCat("the path has ", path.size(), " bytes, not 1 to ", kLongestPath));
  }
  struct stat existing {};
  if (lstat(path.c_str(), &existing) != 0) return absl::OkStatus();
  if (!S_ISSOCK(existing.st_mode)) return absl::UnavailableError("the path exists and is not a socket");
  if (SomebodyListens(path)) return absl::UnavailableError("another server listens there");
  return absl::OkStatus();
}

std::optional<SocketFiles::File> SocketFiles::File::At(const std::string& path) {
  struct stat file {};
  if (lstat(path.c_str(), &file) != 0 || !S_ISSOCK(file.st_mode)) return std::nullopt;
  return File{path, file.st_dev, file.st_ino, file.st_mtim};
}

std::string ProvisionalAddress(const std::string& address) {
  const auto path = SocketPathOf(address);
  if (!path) return address;
  const std::string beside = absl::StrCat(*path, ".", getpid());
  return beside.size() <= kLongestPath ? absl::StrCat("unix:", beside) : address;
}

absl::Status SocketFiles::MoveIntoPlace(const std::string& address) {
  const auto path = SocketPathOf(address), provisional = SocketPathOf(ProvisionalAddress(address));
  if (!path) return absl::OkStatus();
  if (*provisional != *path && rename(provisional->c_str(), path->c_str()) != 0) {
    const absl::Status status = absl::UnavailableError(std::strerror(errno));
    unlink(provisional->c_str());
    return status;
  }
  if (auto file = File::At(*path)) files_.push_back(*std::move(file));
  return absl::OkStatus();
}

void SocketFiles::Remove() const {
  for (const File& file : files_) {
    const auto now = File::At(file.path);
    const bool same = now && now->device == file.device && now->number == file.number &&
                      now->made.tv_sec == file.made.tv_sec && now->made.tv_nsec == file.made.tv_nsec;
    if (same) unlink(file.path.c_str());
  }
}

}  // namespace latvox
