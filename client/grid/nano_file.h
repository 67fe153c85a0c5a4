// OpenVDB grids to .nvdb files. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_NANO_FILE_H_
#define LATVOX_CLIENT_GRID_NANO_FILE_H_

#include <string>

#include "absl/status/status.h"
#include "client/grid/openvdb_trees.h"

namespace latvox::client {

// Writes the grid by NanoVDB's own converter, uncompressed, to `path`, over what is there; not atomic. Its metadata
// latvox_... become one blind data "latvox", of unknown class and type: text, a line "name = value" each. Memory: twice
// the file's. Errors: UNKNOWN, with the path and what NanoVDB or the system says.
absl::Status WriteNanoFile(const openvdb::BoolGrid& grid, const std::string& path);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_NANO_FILE_H_
