// Meshes that are small beside their voxels.
#ifndef LATVOX_CLIENT_TOOL_CLI_FEW_VOXELS_H_
#define LATVOX_CLIENT_TOOL_CLI_FEW_VOXELS_H_

#include <string>

#include "latvox/types.h"

namespace latvox::client {

// Returns a line if the longest side of the mesh is below four voxel sizes, as happens when millimeters are taken for
// meters. Returns "" otherwise, or if the request states a resolution.
std::string FewVoxelsLine(const VoxelizeRequest& request, const Accepted& accepted);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_FEW_VOXELS_H_
