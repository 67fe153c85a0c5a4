#include "client/mesh_files/zip_archive.h"

#include <zip.h>

#include <algorithm>
#include <cstring>

#include "absl/strings/str_cat.h"

namespace latvox::client {
namespace {

absl::Status BadZip(absl::string_view what, zip_error_t* error) {
  return absl::InvalidArgumentError(absl::StrCat(what, " (", zip_error_strerror(error), ")"));
}

struct CloseEntry {
  void operator()(zip_file_t* file) const { zip_fclose(file); }
};

uint64_t ZipNumber(absl::string_view bytes, size_t at, size_t size) {
  uint64_t number = 0;
  std::memcpy(&number, bytes.data() + at, size);
  return number;
}

// Removes bytes before and after the archive, whose directory, followed by its end, tells its size. Archives of zip64
// stay as they are, because their end has no numbers.
absl::string_view WithoutForeign(absl::string_view bytes) {
  constexpr size_t kEnd = 22;
  const size_t end = bytes.rfind(absl::string_view("PK\5\6", 4));
  if (end == absl::string_view::npos || end + kEnd > bytes.size()) return bytes;
  const uint64_t size = ZipNumber(bytes, end + 12, 4), begin = ZipNumber(bytes, end + 16, 4);
  const uint64_t after = end + kEnd + ZipNumber(bytes, end + 20, 2);
  if (size == UINT32_MAX || begin == UINT32_MAX || begin + size > end || after > bytes.size()) return bytes;
  const size_t before = end - size - begin;
  const bool zip64 = end >= 20 && bytes.substr(end - 20, 4) == absl::string_view("PK\6\7", 4);
  return bytes.substr(zip64 ? 0 : before, after - (zip64 ? 0 : before));
}

}  // namespace

void ZipArchive::Discard::operator()(zip* archive) const { zip_discard(archive); }

absl::StatusOr<ZipArchive> ZipArchive::Open(absl::string_view bytes, uint64_t max_bytes) {
  zip_error_t error;
  zip_error_init(&error);
  const absl::string_view archive = WithoutForeign(bytes);
  zip_source_t* source = zip_source_buffer_create(archive.data(), archive.size(), /*freep=*/0, &error);
  ZipArchive out;
  out.foreign_ = bytes.size() - archive.size();
  if (source != nullptr) {
    out.archive_.reset(zip_open_from_source(source, ZIP_RDONLY, &error));
    if (out.archive_ == nullptr) zip_source_free(source);
  }
  absl::Status status;
  if (out.archive_ == nullptr) status = BadZip("is not a complete zip archive", &error);
  zip_error_fini(&error);
  if (!status.ok()) return status;
  out.max_bytes_ = out.left_ = max_bytes;
  return out;
}

absl::StatusOr<std::string> ZipArchive::Read(const std::string& name) {
  constexpr uint64_t kLeast = uint64_t{1} << 16;
  const std::unique_ptr<zip_file_t, CloseEntry> file(zip_fopen(archive_.get(), name.c_str(), ZIP_FL_NOCASE));
  if (file == nullptr) return BadZip(absl::StrCat("part \"", name, "\" cannot be read"), zip_get_error(archive_.get()));
  std::string bytes;
  for (;;) {
    const size_t before = bytes.size();
    bytes.resize(before + std::min(std::max<uint64_t>(kLeast, before), left_ + 1));
    const zip_int64_t count = zip_fread(file.get(), bytes.data() + before, bytes.size() - before);
    if (count < 0) return BadZip(absl::StrCat("part \"", name, "\" is damaged"), zip_file_get_error(file.get()));
    bytes.resize(before + static_cast<size_t>(count));
    if (count == 0) return bytes;
    if (static_cast<uint64_t>(count) > left_) {
      return absl::ResourceExhaustedError(
          absl::StrCat("part \"", name, "\" unpacks to more than the limit of ", max_bytes_, " bytes"));
    }
    left_ -= static_cast<uint64_t>(count);
  }
}

}  // namespace latvox::client
