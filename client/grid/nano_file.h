// Writes OpenVDB grids to .nvdb files. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_NANO_FILE_H_
#define LATVOX_CLIENT_GRID_NANO_FILE_H_

#include <string>

#include "absl/status/status.h"
#include "client/grid/openvdb_trees.h"

namespace latvox::client {

// Writes the grid with NanoVDB's own converter, uncompressed, to `path`, replacing an existing file; not atomic. Its
// metadata latvox_... become one blind data "latvox", of unknown class and type: text, with a line "name = value" each.
// Memory: twice the file's size. Errors: UNKNOWN, with the path and the message of NanoVDB or the system.
absl::Status WriteNanoFile(const openvdb::BoolGrid& grid, const std::string& path);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_NANO_FILE_H_
