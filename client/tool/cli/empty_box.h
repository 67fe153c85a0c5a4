// Requests for a part that does not meet the mesh.
#ifndef LATVOX_CLIENT_TOOL_CLI_EMPTY_BOX_H_
#define LATVOX_CLIENT_TOOL_CLI_EMPTY_BOX_H_

#include <string>

#include "latvox/types.h"

namespace latvox::client {

// Returns a line for a request whose answer holds no voxel: the requested box, and the box of the mesh in the form of
// the option. Returns "" if no box was requested, because a shard may be empty.
std::string EmptyBoxLine(const VoxelizeRequest& request, const Accepted& accepted);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_EMPTY_BOX_H_
