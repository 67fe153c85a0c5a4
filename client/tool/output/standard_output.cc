#include "client/tool/output/standard_output.h"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"

namespace latvox::client {

absl::Status WriteToStandardOutput(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = write(STDOUT_FILENO, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 && errno == EPIPE) break;
    if (count < 0) {
      return absl::UnknownError(absl::StrCat("standard output cannot be written: ", std::strerror(errno)));
    }
    bytes.remove_prefix(static_cast<size_t>(count));
  }
  return absl::OkStatus();
}

StandardOutputFile::StandardOutputFile(std::unique_ptr<ProcessDirectory> directory, const std::string& extension)
    : directory_(std::move(directory)),
      path_(absl::StrCat(directory_->path(), "/output", extension)),
      mark_(directory_->path()) {}

absl::StatusOr<std::unique_ptr<StandardOutputFile>> StandardOutputFile::Create(const std::string& extension) {
  const char* const given = std::getenv("TMPDIR");
  const std::string parent = given != nullptr && *given != '\0' ? given : "/tmp";
  auto directory = ProcessDirectory::Make(parent);
  if (!directory) {
    return absl::FailedPreconditionError(
        absl::StrCat("TMPDIR: a directory in ", parent, " cannot be made: ", std::strerror(errno)));
  }
  return std::unique_ptr<StandardOutputFile>(new StandardOutputFile(std::move(directory), extension));
}

absl::Status StandardOutputFile::Send() const {
  std::ifstream file(path_, std::ios::binary);
  std::vector<char> buffer(size_t{1} << 20);
  while (file.read(buffer.data(), static_cast<std::streamsize>(buffer.size())) || file.gcount() > 0) {
    const std::string_view bytes(buffer.data(), static_cast<size_t>(file.gcount()));
    if (absl::Status status = WriteToStandardOutput(bytes); !status.ok()) return status;
  }
  if (file.eof()) return absl::OkStatus();
  return absl::UnknownError(absl::StrCat(path_, " cannot be read"));
}

}  // namespace latvox::client
