// Reads the .vdb and .nvdb files that commands name.
#ifndef LATVOX_CLIENT_TOOL_CLI_GRID_INPUT_H_
#define LATVOX_CLIENT_TOOL_CLI_GRID_INPUT_H_

#include <string>

#include "absl/status/statusor.h"
#include "latvox/cancellation.h"
#include "latvox/grid/grid_content.h"
#include "latvox/grid/voxel_grid.h"

namespace latvox::client {

// Like ReadForeignInfo and ReadForeignContent. The error of a mesh's file names the command that reads it.
absl::StatusOr<GridFileInfo> ReadInputInfo(const std::string& path, const Cancellation& cancellation = {});
absl::StatusOr<GridContent> ReadInputContent(const std::string& path, bool values, const Cancellation& cancellation);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_GRID_INPUT_H_
