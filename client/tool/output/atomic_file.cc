#include "client/tool/output/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <map>
#include <mutex>
#include <set>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "client/internal/file_error.h"
#include "client/internal/liveness.h"
#include "client/tool/output/temporary_name.h"
#include "latvox/error.h"

namespace latvox::client {
namespace {

constexpr size_t kBufferBytes = 1 << 20;

absl::Status CannotWrite(const std::string& target, const char* why) {
  return WithFile(absl::FailedPreconditionError(absl::StrCat(target, ": cannot be written (", why, ")")), "--out",
                  target);
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

// The named temporary files of all live objects.
struct Temporaries {
  std::mutex mu;
  std::set<std::string> paths;
};

Temporaries& AllTemporaries() {
  static auto& all = *new Temporaries;
  return all;
}

std::string PathOf(int fd) { return absl::StrCat("/proc/self/fd/", fd); }

// Returns false, with errno set, if the file cannot have this name.
bool Link(int fd, const std::string& path) {
  return linkat(AT_FDCWD, PathOf(fd).c_str(), AT_FDCWD, path.c_str(), AT_SYMLINK_FOLLOW) == 0;
}

// Returns a file without a name, or -1.
int OpenUnnamed(const std::filesystem::path& directory) {
  const int fd = open(directory.empty() ? "." : directory.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
  if (fd < 0 || access(PathOf(fd).c_str(), W_OK) == 0) return fd;
  close(fd);  // there is no /proc
  return -1;
}

// Returns whether an unnamed file of this directory can get a name. Some file systems, user namespaces and security
// modules forbid that, and a long job should not find it out at its end. Tries once for each file system.
bool CanLinkBeside(const std::filesystem::path& target) {
  static auto& linkable = *new std::map<dev_t, bool>;  // guarded by AllTemporaries().mu
  const int fd = OpenUnnamed(target.parent_path());
  if (fd < 0) return false;
  struct stat status = {};
  const bool known = fstat(fd, &status) == 0;
  const auto [found, is_new] = linkable.try_emplace(status.st_dev, false);
  if (known && is_new) {
    LockFile(fd, PathOf(fd));
    const std::string path = TakeTemporaryName(target, [fd](const std::string& name) { return Link(fd, name); });
    found->second = !path.empty() && unlink(path.c_str()) == 0;
  }
  close(fd);
  return known && found->second;
}

// Creates the file under a name. Returns its descriptor, or -1 with errno set.
int OpenNamed(const std::filesystem::path& target, std::string& path) {
  int fd = -1;
  path = TakeTemporaryName(target, [&fd](const std::string& name) {
    // Not mkstemp(), so that the mode of the file follows the umask.
    fd = open(name.c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0666);
    if (fd < 0) return false;
    if (LockFile(fd, name) != Lock::kOthers) return true;
    close(fd);  // another process took it for abandoned, and removes it
    errno = EEXIST;
    return false;
  });
  return path.empty() ? -1 : fd;
}

// Returns why the target cannot be written, or "".
std::string WrongPlace(const std::filesystem::path& target) {
  struct stat status = {};
  if (stat(target.c_str(), &status) != 0) {
    if (errno != ENOENT) return std::strerror(errno);
    const std::filesystem::path folder = target.parent_path();
    const bool is_missing = !folder.empty() && stat(folder.c_str(), &status) != 0 && errno == ENOENT;
    return is_missing ? absl::StrCat("there is no folder ", folder.string()) : "";
  }
  if (S_ISDIR(status.st_mode)) return "is a directory";
  // A pipe or device would be replaced instead of written to.
  return S_ISREG(status.st_mode) ? "" : "is not a regular file";
}

}  // namespace

absl::StatusOr<std::unique_ptr<AtomicFile>> AtomicFile::Create(const std::string& target, Form form,
                                                               const Cancellation& cancellation) {
  const std::filesystem::path path = Resolve(target);
  if (const std::string wrong = WrongPlace(path); !wrong.empty()) return CannotWrite(target, wrong.c_str());
  const std::lock_guard lock(AllTemporaries().mu);  // RemoveTemporaryFiles never misses an existing file
  if (form == Form::kUnnamed && CanLinkBeside(path)) {
    if (const int fd = OpenUnnamed(path.parent_path()); fd >= 0) {
      return std::unique_ptr<AtomicFile>(new AtomicFile(path.string(), PathOf(fd), Form::kUnnamed, fd, cancellation));
    }
  }
  std::string temporary;
  const int fd = OpenNamed(path, temporary);
  if (fd < 0) return CannotWrite(target, std::strerror(errno));
  AllTemporaries().paths.insert(temporary);
  return std::unique_ptr<AtomicFile>(new AtomicFile(path.string(), temporary, Form::kNamed, fd, cancellation));
}

AtomicFile::AtomicFile(std::string target, std::string temporary, Form form, int fd, const Cancellation& cancellation)
    : target_(std::move(target)), temporary_(std::move(temporary)), form_(form), fd_(fd), cancellation_(cancellation) {}

AtomicFile::~AtomicFile() {
  if (form_ == Form::kNamed && !committed_) {
    const std::lock_guard lock(AllTemporaries().mu);
    AllTemporaries().paths.erase(temporary_);
    unlink(temporary_.c_str());
  }
  close(fd_);
}

absl::Status AtomicFile::Error(int error_number) const { return CannotWrite(target_, std::strerror(error_number)); }

absl::Status AtomicFile::Named(const absl::Status& error) const {
  if (error.ok()) return error;
  absl::Status named(error.code(), absl::StrReplaceAll(error.message(), {{temporary_, target_}}));
  SetErrorDetails(GetErrorDetails(error), named);
  return named;
}

absl::Status AtomicFile::CheckGoesOn() const {
  return cancellation_.cancelled() ? absl::CancelledError("cancelled") : absl::OkStatus();
}

absl::Status AtomicFile::Append(std::string_view bytes) {
  if (auto status = CheckGoesOn(); !status.ok()) return status;
  buffer_.append(bytes);
  return buffer_.size() < kBufferBytes ? absl::OkStatus() : Flush();
}

absl::Status AtomicFile::Flush() {
  if (auto status = CheckGoesOn(); !status.ok()) return status;
  if (!WriteAll(fd_, buffer_, 0, /*append=*/true)) return Error(errno);
  buffer_.clear();
  return absl::OkStatus();
}

absl::Status AtomicFile::Overwrite(uint64_t offset, std::string_view bytes) {
  if (auto status = Flush(); !status.ok()) return status;
  if (!WriteAll(fd_, bytes, static_cast<off_t>(offset), /*append=*/false)) return Error(errno);
  return absl::OkStatus();
}

absl::Status AtomicFile::Sync() {
  if (auto status = Flush(); !status.ok()) return status;
  return fsync(fd_) == 0 ? absl::OkStatus() : Error(errno);
}

bool AtomicFile::GiveName() {
  if (form_ == Form::kNamed) return rename(temporary_.c_str(), target_.c_str()) == 0;
  if (Link(fd_, target_)) return true;
  if (errno != EEXIST) return false;
  // Only a rename replaces a file. If the process is killed before it, the next writer of the target finds the name.
  LockFile(fd_, temporary_);
  const std::string name = TakeTemporaryName(target_, [this](const std::string& path) { return Link(fd_, path); });
  if (name.empty()) return false;
  if (rename(name.c_str(), target_.c_str()) == 0) return true;
  const int error_number = errno;
  unlink(name.c_str());
  errno = error_number;
  return false;
}

absl::Status AtomicFile::Commit() {
  const std::lock_guard lock(AllTemporaries().mu);
  if (!GiveName()) return Error(errno);
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
