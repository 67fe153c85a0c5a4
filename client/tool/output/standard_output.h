// Standard output as the place of a file.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_STANDARD_OUTPUT_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_STANDARD_OUTPUT_H_

#include <memory>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/internal/process_directory.h"
#include "client/tool/output/atomic_file.h"

namespace latvox::client {

// Writes to standard output. A reader that has closed its end wants no more, so that is no error.
// Errors: UNKNOWN, with the message of the system.
absl::Status WriteToStandardOutput(std::string_view bytes);

// A file that is written like any other, in a directory of its own below TMPDIR or /tmp, and then sent to standard
// output as a whole. Writers of grids need a file in which they can go back. The destructor removes the directory.
class StandardOutputFile {
 public:
  // Errors: FAILED_PRECONDITION, with the directory and the message of the system.
  static absl::StatusOr<std::unique_ptr<StandardOutputFile>> Create(const std::string& extension);
  StandardOutputFile(const StandardOutputFile&) = delete;
  StandardOutputFile& operator=(const StandardOutputFile&) = delete;

  const std::string& path() const { return path_; }

  // Errors: those of reading the file and of WriteToStandardOutput.
  absl::Status Send() const;

 private:
  StandardOutputFile(std::unique_ptr<ProcessDirectory> directory, const std::string& extension);

  const std::unique_ptr<ProcessDirectory> directory_;
  const std::string path_;
  const TemporaryDirectoryMark mark_;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_STANDARD_OUTPUT_H_
