// What was asked for, as our grids tell it. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_REQUEST_METADATA_H_
#define LATVOX_CLIENT_GRID_REQUEST_METADATA_H_

#include <string>

#include "client/grid/openvdb_trees.h"
#include "latvox/types.h"

namespace latvox::client {

// JSON with the fields of a line of `latvox batch`, so that such a line with the mesh repeats the request: all that
// says what the whole is; not which part of it, nor how voxels are sent.
std::string RequestText(const VoxelizeRequest& request, const MeshNote& note);

// The metadata latvox_request, RequestText; and latvox_region, latvox_bounds of a request for these, six numbers each.
void DescribeRequest(const VoxelizeRequest& request, const MeshNote& note, openvdb::GridBase& grid);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_REQUEST_METADATA_H_
