#include <cstring>
#include <exception>
#include <ios>
#include <limits>
#include <new>

#include "absl/strings/str_cat.h"
#include "client/grid/nano_facts.h"
#include "client/grid/nano_frame.h"
#include "client/grid/open_file.h"
#include "client/internal/printable.h"
#include "latvox/grid/voxel_grid.h"

namespace latvox::client {
namespace {

GridFileInfo Describe(const NanoMetaData& header, const nanovdb::GridData& data) {
  GridFileInfo info;
  info.name.assign(data.mGridName, strnlen(data.mGridName, sizeof(data.mGridName)));
  info.value_type = data.mGridType < nanovdb::GridType::End ? NanoTypeName(data.mGridType) : "?";
  info.transform = NanoTransform(data);
  info.active_voxels = header.voxelCount;
  if (header.voxelCount == 0) return info;
  IndexBox& box = info.active_box.emplace();
  for (int n = 0; n < 3; ++n) {
    const int32_t high = header.indexBBox.max()[n];
    box.min[static_cast<size_t>(n)] = header.indexBBox.min()[n];
    box.max[static_cast<size_t>(n)] = high + (high < std::numeric_limits<int32_t>::max());
  }
  return info;
}

absl::Status NotReadable(const std::string& path, const std::string& why) {
  return absl::InvalidArgumentError(absl::StrCat(path, ": is not a readable .nvdb file (", Printable(why), ")"));
}

}  // namespace

absl::StatusOr<GridFileInfo> ReadNanoFileInfo(const std::string& path) {
  auto file = OpenGridFile(path);
  if (!file.ok()) return file.status();
  try {
    const NanoFrameGrid first = ReadNanoFrame(*file).front();
    if (first.is_compressed()) {
      return absl::FailedPreconditionError(absl::StrCat(path, ": its first grid is compressed"));
    }
    const nanovdb::GridData data = ReadNanoData(*file, first);
    GridFileInfo info = Describe(first.header, data);
    info.metadata = ReadNanoMetadata(*file, first, data);
    return info;
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(absl::StrCat(path, ": not enough memory to read it"));
  } catch (const std::ios_base::failure&) {
    return NotReadable(path, "it is cut short");
  } catch (const std::exception& error) {
    return NotReadable(path, error.what());
  }
}

}  // namespace latvox::client
