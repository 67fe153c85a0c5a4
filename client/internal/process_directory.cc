#include "client/internal/process_directory.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/internal/liveness.h"

namespace latvox::client {
namespace {

// Without a tag of the kernel, the names differ from those that RemoveAbandonedDirectories finds.
std::string DirectoryPrefix() { return absl::StrCat("latvox-", KernelTag().empty() ? "untagged" : KernelTag(), "-"); }

int OpenDirectory(const std::string& path) {
  return open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
}

bool IsOurs(int fd) {
  struct stat status = {};
  return fstat(fd, &status) == 0 && status.st_uid == geteuid();
}

void RemoveIfAbandoned(const std::string& path) {
  const int fd = OpenDirectory(path);
  if (fd < 0) return;
  std::error_code ignored;
  if (IsOurs(fd) && LockFile(fd, path) == Lock::kHeld) std::filesystem::remove_all(path, ignored);
  close(fd);
}

void RemoveAbandonedDirectories(const std::string& parent) {
  if (KernelTag().empty()) return;
  std::vector<std::string> paths;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(parent, error), end; !error && entry != end; entry.increment(error)) {
    if (absl::StartsWith(entry->path().filename().string(), DirectoryPrefix())) paths.push_back(entry->path().string());
  }
  for (const std::string& path : paths) RemoveIfAbandoned(path);
}

}  // namespace

std::unique_ptr<ProcessDirectory> ProcessDirectory::Make(const std::string& parent) {
  RemoveAbandonedDirectories(parent);
  for (;;) {
    std::string path = absl::StrCat(parent, "/", DirectoryPrefix(), "XXXXXX");
    if (mkdtemp(path.data()) == nullptr) return nullptr;
    const int fd = OpenDirectory(path);
    if (fd < 0 && errno != ENOENT) {
      const int error_number = errno;
      rmdir(path.c_str());
      errno = error_number;
      return nullptr;
    }
    // Before its lock, another process may remove the directory.
    if (fd >= 0 && LockFile(fd, path) != Lock::kOthers) {
      return std::unique_ptr<ProcessDirectory>(new ProcessDirectory(std::move(path), fd));
    }
    if (fd >= 0) close(fd);
  }
}

ProcessDirectory::ProcessDirectory(std::string path, int fd) : path_(std::move(path)), fd_(fd) {}

ProcessDirectory::~ProcessDirectory() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
  close(fd_);
}

}  // namespace latvox::client
