// Writes OpenVDB grids to .nvdb files. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_NANO_FILE_H_
#define LATVOX_CLIENT_GRID_NANO_FILE_H_

#include <string>

#include "absl/status/status.h"
#include "client/grid/late_grids.h"
#include "client/grid/openvdb_trees.h"
#include "latvox/cancellation.h"

namespace latvox::client {

// Writes the grids with NanoVDB's own converter, uncompressed, to `path`, replacing an existing file; not atomic. Each
// grid is a segment of the file. Its metadata latvox_... become one blind data "latvox", of unknown class and type:
// text, with a line "name = value" each. Memory: twice the size of the largest grid. Errors: UNKNOWN, with the path and
// the message of NanoVDB or the system; CANCELLED, except while NanoVDB converts a grid, which nothing can stop.
//   grids, late   of bool, float, int32 or three floats
absl::Status WriteNanoFile(const openvdb::GridCPtrVec& grids, const std::string& path, const LateGrids& late = {},
                           const Cancellation& cancellation = {});

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_NANO_FILE_H_
