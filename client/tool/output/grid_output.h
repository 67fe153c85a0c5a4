// Grids of OpenVDB and NanoVDB.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_GRID_OUTPUT_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_GRID_OUTPUT_H_

#include <memory>
#include <vector>

#include "client/tool/output/atomic_file.h"
#include "client/tool/output/output.h"
#include "client/tool/vdb/vdb.h"
#include "latvox/types.h"

namespace latvox::client {

// Returns whether a file of voxels with these fields needs OpenVDB's library. A set of voxels alone is written without.
bool NeedsOpenVdb(VdbFormat format, const std::vector<Field>& fields);

// .vdb, .nvdb: see latvox/grid/voxel_grid.h and latvox/grid/field_grids.h. A band with distances alone is a level set,
// as far as it is one: see client/grid/distance_grid.cc. Errors: those of Vdb::Load.
std::unique_ptr<Output> NewGridOutput(std::unique_ptr<AtomicFile> file, VdbFormat format,
                                      const VoxelizeRequest& request, const OutputOptions& options);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_GRID_OUTPUT_H_
