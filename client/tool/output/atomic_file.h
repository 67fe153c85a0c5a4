// Files that appear whole or not at all.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_ATOMIC_FILE_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_ATOMIC_FILE_H_

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "latvox/cancellation.h"

namespace latvox::client {

// An unfinished file on the file system of its target. Commit moves it to the target. Without Commit, the target stays
// as it was, and the file disappears, even if the process is killed. Not thread-safe. Errors: FAILED_PRECONDITION, with
// the target and the message of the system; CANCELLED.
class AtomicFile {
 public:
  // How the file exists before Commit.
  enum class Form {
    kUnnamed,  // without a name, if the file system has such files; otherwise kNamed
    kNamed,    // under the name of client/tool/output/temporary_name.h
  };

  // Errors: the directory is missing or not writable, or the target is a directory, a pipe or anything else that is not
  // a regular file, or its name is too long.
  //   cancellation   then Append, Overwrite and Sync fail, so that writers stop soon
  static absl::StatusOr<std::unique_ptr<AtomicFile>> Create(const std::string& target, Form form = Form::kUnnamed,
                                                            const Cancellation& cancellation = {});
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  const std::string& target() const { return target_; }
  // A path of the unfinished file, for libraries that open files by name. They must not replace it.
  const std::string& temporary() const { return temporary_; }

  // For writers that do not append, or seldom: they look before each piece of work.
  const Cancellation& cancellation() const { return cancellation_; }
  absl::Status CheckGoesOn() const;  // CANCELLED, or OK

  // Returns the error of a library with the target's name in place of temporary().
  absl::Status Named(const absl::Status& error) const;

  // Appends bytes. They are buffered: a later call may report the error.
  absl::Status Append(std::string_view bytes);

  // Overwrites bytes that were appended, for headers that hold a count.
  absl::Status Overwrite(uint64_t offset, std::string_view bytes);

  // Writes everything to the disk.
  absl::Status Sync();

  // Gives the file the target's name. Precondition: Sync succeeded.
  absl::Status Commit();

 private:
  AtomicFile(std::string target, std::string temporary, Form form, int fd, const Cancellation& cancellation);
  absl::Status Flush();
  absl::Status Error(int error_number) const;
  bool GiveName();  // false: errno is set

  std::string target_, temporary_, buffer_;
  const Form form_;
  int fd_;
  const Cancellation cancellation_;
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

// Removes the named temporary files of all live objects, and marked directories with their content. It is for a process
// that ends without destructors.
void RemoveTemporaryFiles();

// Writes these bytes to a file at the target.
absl::Status WriteAtomically(const std::string& target, std::string_view bytes);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_ATOMIC_FILE_H_
