#include "client/tool/inspect/byte_source.h"

#include <array>
#include <filesystem>
#include <system_error>

namespace latvox::client {

absl::Status ByteSource::Read(void* to, size_t count) {
  const auto got = ReadSome(static_cast<char*>(to), count);
  if (!got.ok()) return got.status();
  return *got == count ? absl::OkStatus() : Bad("is cut short");
}

absl::Status ByteSource::CheckEnd() {
  char more;
  const auto got = ReadSome(&more, 1);
  if (!got.ok()) return got.status();
  return *got == 0 ? absl::OkStatus() : Bad("goes on after its content");
}

absl::StatusOr<std::unique_ptr<FileSource>> FileSource::Open(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return absl::NotFoundError(absl::StrCat(path, ": no such file"));
  if (!std::filesystem::is_regular_file(path, error)) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": is not a regular file"));
  }
  const uint64_t size = std::filesystem::file_size(path, error);
  std::unique_ptr<FileSource> source(new FileSource(path, size));
  if (error || !source->file_) return absl::InvalidArgumentError(absl::StrCat(path, ": cannot be read"));
  return source;
}

absl::StatusOr<size_t> FileSource::ReadSome(char* to, size_t count) {
  file_.read(to, static_cast<std::streamsize>(count));
  const auto got = static_cast<size_t>(file_.gcount());
  at_ += got;
  return got;
}

absl::Status FileSource::Skip(uint64_t count) {
  if (count > size_ - at_) return Bad("is cut short");
  file_.seekg(static_cast<std::streamoff>(count), std::ios::cur);
  at_ += count;
  return absl::OkStatus();
}

absl::StatusOr<bool> FileSource::ReadLine(std::string& line) {
  std::array<char, size_t{1} << 16> buffer;
  file_.getline(buffer.data(), buffer.size());
  const auto got = static_cast<size_t>(file_.gcount());
  if (file_.fail() && got > 0) return Bad("has a line of more than ", buffer.size() - 1, " bytes");
  at_ += got;
  line = buffer.data();
  if (!line.empty() && line.back() == '\r') line.pop_back();
  return !file_.fail();
}

}  // namespace latvox::client
