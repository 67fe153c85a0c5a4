// `latvox info --json`.
#ifndef LATVOX_CLIENT_TOOL_CLI_INFO_JSON_H_
#define LATVOX_CLIENT_TOOL_CLI_INFO_JSON_H_

#include <string>

#include "latvox/grid/voxel_grid.h"

namespace latvox::client {

// Returns an object: `grid` (name and type), `voxels`, `index_box` (min, max; null without voxels), `voxel_size`,
// `basis` (9 numbers), `origin`, and `metadata`, each entry as the text that `latvox info` prints.
std::string ToJson(const GridFileInfo& info);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_INFO_JSON_H_
