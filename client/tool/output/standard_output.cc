#include "client/tool/output/standard_output.h"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>
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

StandardOutputFile::StandardOutputFile(const std::string& directory, const std::string& extension)
    : directory_(directory), path_(absl::StrCat(directory, "/output", extension)), mark_(directory) {}

absl::StatusOr<std::unique_ptr<StandardOutputFile>> StandardOutputFile::Create(const std::string& extension) {
  const char* const parent = std::getenv("TMPDIR");
  std::string directory = absl::StrCat(parent != nullptr && *parent != '\0' ? parent : "/tmp", "/latvox-XXXXXX");
  if (mkdtemp(directory.data()) == nullptr) {
    return absl::FailedPreconditionError(
        absl::StrCat("TMPDIR: the directory ", directory, " cannot be made: ", std::strerror(errno)));
  }
  return std::unique_ptr<StandardOutputFile>(new StandardOutputFile(directory, extension));
}

StandardOutputFile::~StandardOutputFile() {
  std::error_code ignored;
  std::filesystem::remove_all(directory_, ignored);
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
