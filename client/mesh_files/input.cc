#include "client/mesh_files/input.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <new>
#include <system_error>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"

namespace latvox::client {
namespace {

// Becomes readable when reading is to stop.
int StopEvent() {
  static const int event = eventfd(0, EFD_CLOEXEC);
  return event;
}

// Waits for bytes or their end. Returns false if reading is to stop.
bool AwaitBytes(int fd) {
  pollfd sources[] = {{fd, POLLIN, 0}, {StopEvent(), POLLIN, 0}};
  while (poll(sources, 2, -1) < 0 && errno == EINTR) {
  }
  return sources[1].revents == 0;
}

// No stream: it treats an error of the device as the end of the file.
absl::StatusOr<std::string> ReadAll(int fd, const std::string& path) try {
  struct stat file {};
  const bool is_sized = fstat(fd, &file) == 0 && S_ISREG(file.st_mode);
  std::string bytes(is_sized ? static_cast<size_t>(file.st_size) + 1 : size_t{1} << 16, '\0');
  for (size_t size = 0;;) {
    if (size == bytes.size()) bytes.resize(2 * size);
    if (!AwaitBytes(fd)) return absl::CancelledError("cancelled");
    const ssize_t got = read(fd, bytes.data() + size, bytes.size() - size);
    if (got < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (got < 0) {
      return absl::FailedPreconditionError(
          absl::StrCat(NameOfInput(path), ": cannot be read to its end (", std::strerror(errno), ")"));
    }
    size += static_cast<size_t>(got);
    if (got > 0) continue;
    bytes.resize(size);
    if (bytes.empty()) return absl::InvalidArgumentError(absl::StrCat(NameOfInput(path), ": is empty"));
    return bytes;
  }
} catch (const std::bad_alloc&) {
  return absl::ResourceExhaustedError(absl::StrCat(NameOfInput(path), ": is larger than the available memory"));
}

}  // namespace

std::string NameOfInput(const std::string& path) { return path == kStandardInput ? "standard input" : path; }

absl::StatusOr<std::string> ReadStandardInput(const char* what) {
  if (isatty(STDIN_FILENO) == 1) {
    return absl::InvalidArgumentError(
        absl::StrCat("standard input: is a terminal; pipe or redirect ", what, " into it (| or <)"));
  }
  struct stat file {};
  if (fstat(STDIN_FILENO, &file) != 0 || (file.st_mode & S_IFMT) == 0) {  // a library's eventfd has no type
    return absl::InvalidArgumentError("standard input: is closed");
  }
  return ReadAll(STDIN_FILENO, kStandardInput);
}

absl::StatusOr<std::string> ReadBytes(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": is a directory"));
  }
  if (!std::filesystem::exists(path, error)) return absl::NotFoundError(absl::StrCat(path, ": no such file"));
  // O_NONBLOCK: otherwise open() would wait for the writer of a pipe, and nothing could end it.
  const int fd = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": cannot be read (", std::strerror(errno), ")"));
  }
  const absl::Cleanup close_file = [fd] { close(fd); };
  return ReadAll(fd, path);
}

void StopReading() {
  const uint64_t one = 1;
  // Fails only where the event is set already: its counter has no room.
  static_cast<void>(!write(StopEvent(), &one, sizeof(one)));
}

}  // namespace latvox::client
