// `latvox info --json`.
#ifndef LATVOX_CLIENT_TOOL_CLI_INFO_JSON_H_
#define LATVOX_CLIENT_TOOL_CLI_INFO_JSON_H_

#include <string>

#include "latvox/grid/voxel_grid.h"

namespace latvox::client {

// An object: `grid` (name and type), `voxels`, `index_box` (min, max; null of no voxel), `voxel_size`, `basis` (9
// numbers), `origin`, and `metadata`, each as the text that `latvox info` prints.
std::string ToJson(const GridFileInfo& info);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_INFO_JSON_H_
