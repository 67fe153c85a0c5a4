// The transform of a grid as a .vdb file has it, without OpenVDB. Internal to latvox::grid and the tool.
#ifndef LATVOX_CLIENT_GRID_GRID_TRANSFORM_H_
#define LATVOX_CLIENT_GRID_GRID_TRANSFORM_H_

#include <string>

#include "latvox/types.h"

namespace latvox::client {

// Returns the bytes of the simplest map that has the transform, as OpenVDB chooses it. Some programs read scales faster
// than other maps. Precondition: CheckGridTransform(transform) is OK.
std::string TransformBytes(const GridTransform& transform);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_GRID_TRANSFORM_H_
