// Files that appear whole or not at all.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_ATOMIC_FILE_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_ATOMIC_FILE_H_

#include <memory>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace latvox::client {

// A temporary file beside its target. Commit moves it to the target. Without Commit, the destructor removes it, and the
// target stays as it was. Not thread-safe.
// Errors: FAILED_PRECONDITION, with the target and the message of the system.
class AtomicFile {
 public:
  // Errors: the directory is missing or not writable, or the target is a directory, a pipe or anything else that is not
  // a regular file.
  static absl::StatusOr<std::unique_ptr<AtomicFile>> Create(const std::string& target);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  const std::string& target() const { return target_; }
  const std::string& temporary() const { return temporary_; }  // for libraries that write by name

  // Appends bytes. They are buffered: a later call may report the error.
  absl::Status Append(std::string_view bytes);

  // Overwrites the first bytes of the file, for headers that hold a count.
  absl::Status WriteAtStart(std::string_view bytes);

  // Writes everything to the disk.
  absl::Status Sync();

  // Renames the file to the target. Precondition: Sync succeeded.
  absl::Status Commit();

 private:
  AtomicFile(std::string target, std::string temporary, int fd);
  absl::Status Flush();
  absl::Status Error(int error_number) const;

  std::string target_, temporary_, buffer_;
  int fd_;
  bool committed_ = false;
};

// Marks a temporary directory. Its creator removes it.
class TemporaryDirectoryMark {
 public:
  explicit TemporaryDirectoryMark(std::string path);
  ~TemporaryDirectoryMark();
  TemporaryDirectoryMark(const TemporaryDirectoryMark&) = delete;
  TemporaryDirectoryMark& operator=(const TemporaryDirectoryMark&) = delete;

 private:
  const std::string path_;
};

// Removes the temporary files of all live objects, and marked directories with their content. It is for a process that
// ends without destructors.
void RemoveTemporaryFiles();

// Writes these bytes to a file at the target.
absl::Status WriteAtomically(const std::string& target, std::string_view bytes);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_ATOMIC_FILE_H_
