#include "client/grid/open_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "absl/strings/str_cat.h"

namespace latvox::client {

absl::StatusOr<std::ifstream> OpenGridFile(const std::string& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) return absl::NotFoundError(absl::StrCat(path, ": no such file"));
  if (!std::filesystem::is_regular_file(status)) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": is not a file"));
  }
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (file.is_open()) return file;
  return absl::InvalidArgumentError(absl::StrCat(path, ": cannot be opened (", std::strerror(errno), ")"));
}

uint64_t ReadMagic(std::istream& in) {
  uint64_t magic = 0;
  const bool is_there = in.read(reinterpret_cast<char*>(&magic), sizeof(magic)).good();
  in.clear();
  in.seekg(0);
  return is_there ? magic : 0;
}

absl::Status NoGrid(const std::string& path) {
  return absl::InvalidArgumentError(absl::StrCat(path, ": holds no grid"));
}

}  // namespace latvox::client
