// Reads .vdb files from streams, for a process that may read but not open files. Internal to latvox::grid and the tool.
#ifndef LATVOX_CLIENT_GRID_GRID_STREAM_H_
#define LATVOX_CLIENT_GRID_GRID_STREAM_H_

#include <istream>
#include <string>

#include "absl/status/statusor.h"
#include "latvox/grid/grid_content.h"
#include "latvox/grid/voxel_grid.h"

namespace latvox::client {

// Like the functions of the same names in the public headers, except that nothing is opened. `path` is for messages.
absl::StatusOr<GridFileInfo> ReadGridFileInfo(std::istream& in, const std::string& path);
absl::StatusOr<GridContent> ReadGridContent(std::istream& in, const std::string& path, bool values);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_GRID_STREAM_H_
