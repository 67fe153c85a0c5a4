// Writes OpenVDB grids to .vdb files. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_GRID_FILE_H_
#define LATVOX_CLIENT_GRID_GRID_FILE_H_

#include <string>

#include "absl/status/status.h"
#include "client/grid/late_grids.h"
#include "client/grid/openvdb_trees.h"
#include "latvox/cancellation.h"

namespace latvox::client {

// Writes a .vdb file to `path`, replacing an existing file; not atomic. The grids' trees write themselves, node by
// node, so the memory depends on the trees. Errors: UNKNOWN, with the path and the message of OpenVDB or the system;
// CANCELLED.
//   grids, late   with different names
absl::Status WriteGridFile(const openvdb::GridCPtrVec& grids, const std::string& path, const LateGrids& late = {},
                           const Cancellation& cancellation = {});

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_GRID_FILE_H_
