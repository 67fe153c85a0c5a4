// OpenVDB grids to .vdb files. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_GRID_FILE_H_
#define LATVOX_CLIENT_GRID_GRID_FILE_H_

#include <string>

#include "absl/status/status.h"
#include "client/grid/openvdb_trees.h"

namespace latvox::client {

// Writes a .vdb file to `path`, over what is there; not atomic. The grids' trees write themselves, node by node, so
// that memory is the trees' matter. Errors: UNKNOWN, with the path and what OpenVDB or the system says.
absl::Status WriteGridFile(const openvdb::GridCPtrVec& grids, const std::string& path);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_GRID_FILE_H_
