#include "client/internal/liveness.h"

#include <sys/file.h>
#include <sys/stat.h>

#include <cerrno>
#include <fstream>

namespace latvox::client {

const std::string& KernelTag() {
  static const auto* const kTag = [] {
    constexpr size_t kCharacters = 8;
    std::string id;
    std::ifstream("/proc/sys/kernel/random/boot_id") >> id;
    return new std::string(id.size() < kCharacters ? "" : id.substr(0, kCharacters));
  }();
  return *kTag;
}

Lock LockFile(int fd, const std::string& path) {
  while (flock(fd, LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK) return Lock::kOthers;
    if (errno != EINTR) return Lock::kUnsupported;
  }
  // Before the lock, another process may have taken this file for abandoned.
  struct stat opened = {}, named = {};
  const bool same = fstat(fd, &opened) == 0 && lstat(path.c_str(), &named) == 0 && opened.st_dev == named.st_dev &&
                    opened.st_ino == named.st_ino;
  return same ? Lock::kHeld : Lock::kOthers;
}

}  // namespace latvox::client
