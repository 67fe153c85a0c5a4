// The OpenVDB grid within a VoxelGrid. It includes OpenVDB's headers, which cost 2.5 seconds of compile time a file.
#ifndef LATVOX_LATVOX_GRID_OPENVDB_GRID_H_
#define LATVOX_LATVOX_GRID_OPENVDB_GRID_H_

#include <openvdb/openvdb.h>

#include "latvox/grid/voxel_grid.h"

namespace latvox::client {

// The result of VoxelGrid::content().
struct VoxelGrid::Content {
  openvdb::BoolGrid::Ptr grid;  // never null; shares its tree with copies of the pointer
};

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_GRID_OPENVDB_GRID_H_
