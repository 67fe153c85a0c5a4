// Files that are read from front to back, in bounded memory.
#ifndef LATVOX_CLIENT_TOOL_INSPECT_BYTE_SOURCE_H_
#define LATVOX_CLIENT_TOOL_INSPECT_BYTE_SOURCE_H_

#include <cstdint>
#include <fstream>
#include <memory>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"

namespace latvox::client {

// A stream of bytes with a name for errors. Not thread-safe.
class ByteSource {
 public:
  explicit ByteSource(std::string name) : name_(std::move(name)) {}
  virtual ~ByteSource() = default;
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;

  // Returns how many bytes were read; fewer than `count` only at the end. Errors: INVALID_ARGUMENT: damaged.
  virtual absl::StatusOr<size_t> ReadSome(char* to, size_t count) = 0;

  // Reads exactly this many bytes. Errors: INVALID_ARGUMENT: the end comes before, or damaged.
  absl::Status Read(void* to, size_t count);

  // Errors: INVALID_ARGUMENT: there are bytes left.
  absl::Status CheckEnd();

  // Returns INVALID_ARGUMENT with the name before the words.
  template <class... Words>
  absl::Status Bad(const Words&... words) const {
    return absl::InvalidArgumentError(absl::StrCat(name_, ": ", words...));
  }

 private:
  const std::string name_;
};

class FileSource final : public ByteSource {
 public:
  // Errors, with the path: NOT_FOUND; INVALID_ARGUMENT: not a regular file, or not readable.
  static absl::StatusOr<std::unique_ptr<FileSource>> Open(const std::string& path);

  absl::StatusOr<size_t> ReadSome(char* to, size_t count) override;

  // Errors: INVALID_ARGUMENT: the file has fewer bytes left.
  absl::Status Skip(uint64_t count);

  // Reads a line without its end. Errors: INVALID_ARGUMENT: longer than 64 KiB.
  //   returns   false at the end of the file
  absl::StatusOr<bool> ReadLine(std::string& line);

  uint64_t size() const { return size_; }
  uint64_t at() const { return at_; }

 private:
  FileSource(const std::string& path, uint64_t size) : ByteSource(path), file_(path, std::ios::binary), size_(size) {}

  std::ifstream file_;
  const uint64_t size_;
  uint64_t at_ = 0;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_INSPECT_BYTE_SOURCE_H_
