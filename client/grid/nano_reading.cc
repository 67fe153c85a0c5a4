#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "client/grid/nano_facts.h"
#include "latvox/grid/voxel_grid.h"

namespace latvox::client {
namespace {

// Reads the file's structures without its nodes.
class NanoReader {
 public:
  explicit NanoReader(const std::string& path) : path_(path), file_(path, std::ios::binary) {
    std::error_code error;
    size_ = std::filesystem::file_size(path, error);
  }

  absl::StatusOr<GridFileInfo> Read() {
    NanoFileHeader header;
    if (!Get(header) || !IsNanoMagic(header.magic) || header.gridCount == 0) return Bad("has no grid");
    NanoMetaData meta;
    for (uint16_t n = 0; n < header.gridCount; ++n) {
      NanoMetaData each;
      if (!Get(each) || each.nameSize > kMostNanoText) return Bad("is cut short");
      if (n == 0) meta = each;
      file_.seekg(each.nameSize, std::ios::cur);
    }
    if (meta.codec != nanovdb::io::Codec::NONE) return Bad("is compressed");
    const auto begin = static_cast<uint64_t>(file_.tellg());
    nanovdb::GridData grid;
    if (!Get(grid) || !IsNanoMagic(grid.mMagic)) return Bad("has no grid behind its header");
    if (grid.mGridSize > size_ || begin > size_ - grid.mGridSize) return Bad("is cut short");
    GridFileInfo info = Describe(meta, grid);
    info.metadata = NanoMetadata(grid, [&](uint64_t at, void* to, uint64_t bytes) {
      file_.seekg(static_cast<std::streamoff>(begin + at));
      return file_.read(static_cast<char*>(to), static_cast<std::streamsize>(bytes)).good();
    });
    return info;
  }

 private:
  absl::Status Bad(const char* why) const {
    return absl::InvalidArgumentError(absl::StrCat(path_, ": is not a readable .nvdb file (", why, ")"));
  }

  template <class T>
  bool Get(T& value) {
    file_.read(reinterpret_cast<char*>(&value), sizeof(value));
    return file_.good();
  }

  static GridFileInfo Describe(const NanoMetaData& meta, const nanovdb::GridData& grid) {
    GridFileInfo info;
    info.name.assign(grid.mGridName, strnlen(grid.mGridName, sizeof(grid.mGridName)));
    info.value_type = grid.mGridType < nanovdb::GridType::End ? NanoTypeName(grid.mGridType) : "?";
    info.transform = NanoTransform(grid);
    info.active_voxels = meta.voxelCount;
    if (meta.voxelCount == 0) return info;
    IndexBox& box = info.active_box.emplace();
    for (int n = 0; n < 3; ++n) {
      const int32_t high = meta.indexBBox.max()[n];
      box.min[static_cast<size_t>(n)] = meta.indexBBox.min()[n];
      box.max[static_cast<size_t>(n)] = high + (high < std::numeric_limits<int32_t>::max());
    }
    return info;
  }

  const std::string path_;
  std::ifstream file_;
  uint64_t size_ = 0;
};

}  // namespace

absl::StatusOr<GridFileInfo> ReadNanoFileInfo(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return absl::NotFoundError(absl::StrCat(path, ": no such file"));
  return NanoReader(path).Read();
}

}  // namespace latvox::client
