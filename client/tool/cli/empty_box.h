// Parts of a mesh in which there is none of it.
#ifndef LATVOX_CLIENT_TOOL_CLI_EMPTY_BOX_H_
#define LATVOX_CLIENT_TOOL_CLI_EMPTY_BOX_H_

#include <string>

#include "latvox/types.h"

namespace latvox::client {

// For people, of a request whose answer holds no voxel: which box was asked for, and which one the mesh lies in, as the
// option takes it. Empty if no box was asked for: a shard may well hold none.
std::string EmptyBoxLine(const VoxelizeRequest& request, const Accepted& accepted);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_EMPTY_BOX_H_
