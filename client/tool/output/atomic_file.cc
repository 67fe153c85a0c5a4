#include "client/tool/output/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <random>
#include <set>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"

namespace latvox::client {
namespace {

constexpr size_t kBufferBytes = 1 << 20;

absl::Status CannotWrite(const std::string& target, const char* why) {
  return absl::FailedPreconditionError(absl::StrCat(target, ": cannot be written (", why, ")"));
}

// Returns false, with errno set, if some bytes could not be written.
bool WriteAll(int fd, std::string_view bytes, off_t at, bool append) {
  while (!bytes.empty()) {
    const ssize_t n = append ? write(fd, bytes.data(), bytes.size()) : pwrite(fd, bytes.data(), bytes.size(), at);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return false;
    bytes.remove_prefix(static_cast<size_t>(n));
    at += n;
  }
  return true;
}

// Returns the file that a symbolic link leads to, or would lead to, so that replacing it keeps the link.
std::filesystem::path Resolve(std::filesystem::path target) {
  constexpr int kMostLinks = 40;
  std::error_code error;
  for (int links = 0; links < kMostLinks && std::filesystem::is_symlink(target, error); ++links) {
    const auto leads_to = std::filesystem::read_symlink(target, error);
    target = target.parent_path() / leads_to;  // an absolute link replaces the parent path
  }
  return target;
}

// The temporary files of all live objects.
struct Temporaries {
  std::mutex mu;
  std::set<std::string> paths;
};

Temporaries& AllTemporaries() {
  static auto& all = *new Temporaries;
  return all;
}

}  // namespace

absl::StatusOr<std::unique_ptr<AtomicFile>> AtomicFile::Create(const std::string& target) {
  const std::filesystem::path path = Resolve(target);
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    return CannotWrite(target, "is a directory");
  }
  // A pipe or device would be replaced instead of written to.
  if (std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error)) {
    return CannotWrite(target, "is not a regular file");
  }
  std::random_device random;
  for (;;) {
    const std::string name = absl::StrCat(".", path.filename().string(), ".", absl::Hex(random()), ".part");
    const std::string temporary = (path.parent_path() / name).string();
    // open() instead of mkstemp(), so that the mode of the file follows the umask.
    const std::lock_guard lock(AllTemporaries().mu);  // RemoveTemporaryFiles never misses an existing file
    const int fd = open(temporary.c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0666);
    if (fd >= 0) AllTemporaries().paths.insert(temporary);
    if (fd >= 0) return std::unique_ptr<AtomicFile>(new AtomicFile(path.string(), temporary, fd));
    if (errno != EEXIST) return CannotWrite(target, std::strerror(errno));
  }
}

AtomicFile::AtomicFile(std::string target, std::string temporary, int fd)
    : target_(std::move(target)), temporary_(std::move(temporary)), fd_(fd) {}

AtomicFile::~AtomicFile() {
  close(fd_);
  const std::lock_guard lock(AllTemporaries().mu);
  AllTemporaries().paths.erase(temporary_);
  if (!committed_) unlink(temporary_.c_str());
}

absl::Status AtomicFile::Error(int error_number) const { return CannotWrite(target_, std::strerror(error_number)); }

absl::Status AtomicFile::Append(std::string_view bytes) {
  buffer_.append(bytes);
  return buffer_.size() < kBufferBytes ? absl::OkStatus() : Flush();
}

absl::Status AtomicFile::Flush() {
  if (!WriteAll(fd_, buffer_, 0, /*append=*/true)) return Error(errno);
  buffer_.clear();
  return absl::OkStatus();
}

absl::Status AtomicFile::WriteAtStart(std::string_view bytes) {
  if (auto status = Flush(); !status.ok()) return status;
  if (!WriteAll(fd_, bytes, 0, /*append=*/false)) return Error(errno);
  return absl::OkStatus();
}

absl::Status AtomicFile::Sync() {
  if (auto status = Flush(); !status.ok()) return status;
  // By name, because a library that writes by name may have replaced the file.
  const int fd = open(temporary_.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return Error(errno);
  const int result = fsync(fd), error_number = errno;
  close(fd);
  return result == 0 ? absl::OkStatus() : Error(error_number);
}

absl::Status AtomicFile::Commit() {
  const std::lock_guard lock(AllTemporaries().mu);
  if (rename(temporary_.c_str(), target_.c_str()) != 0) return Error(errno);
  AllTemporaries().paths.erase(temporary_);
  committed_ = true;
  return absl::OkStatus();
}

TemporaryDirectoryMark::TemporaryDirectoryMark(std::string path) : path_(std::move(path)) {
  const std::lock_guard lock(AllTemporaries().mu);
  AllTemporaries().paths.insert(path_);
}

TemporaryDirectoryMark::~TemporaryDirectoryMark() {
  const std::lock_guard lock(AllTemporaries().mu);
  AllTemporaries().paths.erase(path_);
}

void RemoveTemporaryFiles() {
  const std::lock_guard lock(AllTemporaries().mu);
  std::error_code ignored;
  for (const std::string& path : AllTemporaries().paths) std::filesystem::remove_all(path, ignored);
}

absl::Status WriteAtomically(const std::string& target, std::string_view bytes) {
  const auto file = AtomicFile::Create(target);
  if (!file.ok()) return file.status();
  if (auto status = (*file)->Append(bytes); !status.ok()) return status;
  if (auto status = (*file)->Sync(); !status.ok()) return status;
  return (*file)->Commit();
}

}  // namespace latvox::client
