#include <exception>
#include <filesystem>

#include "absl/strings/str_cat.h"
#include "client/grid/grid_frame.h"
#include "client/grid/open_file.h"
#include "client/internal/printable.h"
#include "latvox/grid/voxel_grid.h"

namespace latvox::client {

absl::StatusOr<std::string> ReadGridFileDigest(const std::string& path) {
  auto file = OpenGridFile(path);
  if (!file.ok()) return file.status();
  try {
    const GridFrame frame = ReadGridFrame(*file, std::filesystem::file_size(path));
    if (frame.grids.empty()) return NoGrid(path);
    for (const FrameMetadata& metadata : frame.grids.front().metadata) {
      if (metadata.name == "latvox_digest" && metadata.type == "string") return metadata.value;
    }
    return "";
  } catch (const std::exception& error) {
    return absl::InvalidArgumentError(
        absl::StrCat(path, ": is not a readable .vdb file (", Printable(error.what()), ")"));
  }
}

}  // namespace latvox::client
