// A set of voxels without fields, for a .vdb file that is written without OpenVDB.
#ifndef LATVOX_CLIENT_TOOL_VDB_BRICK_GRID_H_
#define LATVOX_CLIENT_TOOL_VDB_BRICK_GRID_H_

#include "client/tool/vdb/vdb.h"
#include "latvox/types.h"

namespace latvox::client {

// Returns an empty grid, whose file is that of WriteVoxelFile; precondition of Write: VdbFormat::kOpenVdb. Memory: that
// of LowerNode. Errors: those of CheckGridTransform; of Add, RESOURCE_EXHAUSTED (memory).
Vdb::NewGrid NewBrickGrid(const GridTransform& transform);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_VDB_BRICK_GRID_H_
