// The request in the metadata of our grids. Internal to latvox::grid and the tool.
#ifndef LATVOX_CLIENT_GRID_REQUEST_METADATA_H_
#define LATVOX_CLIENT_GRID_REQUEST_METADATA_H_

#include <string>

#include "client/grid/metadata.h"
#include "latvox/types.h"

namespace latvox::client {

// Returns JSON with the fields of a line of `latvox batch`, so that such a line with the mesh repeats the request. It
// describes the whole, but not the part of it, nor the encoding of voxels.
std::string RequestText(const VoxelizeRequest& request, const MeshNote& note);

// Returns the metadata latvox_request, RequestText; and, if the request or the note has them, latvox_region,
// latvox_bounds and latvox_mesh_box, six numbers each, and latvox_mesh_triangles.
Metadata RequestMetadata(const VoxelizeRequest& request, const MeshNote& note);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_REQUEST_METADATA_H_
