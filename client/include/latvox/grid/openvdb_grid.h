// The OpenVDB grid within a VoxelGrid. Costs OpenVDB's headers: 2.5 seconds a file.
#ifndef LATVOX_LATVOX_GRID_OPENVDB_GRID_H_
#define LATVOX_LATVOX_GRID_OPENVDB_GRID_H_

#include <openvdb/openvdb.h>

#include "latvox/grid/voxel_grid.h"

namespace latvox::client {

// What VoxelGrid::content() gives.
struct VoxelGrid::Content {
  openvdb::BoolGrid::Ptr grid;  // never null; shares its tree with copies of the pointer
};

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_GRID_OPENVDB_GRID_H_
