// The grids of a .nvdb file, read from a stream. Includes OpenVDB's headers. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_NANO_ARCHIVE_H_
#define LATVOX_CLIENT_GRID_NANO_ARCHIVE_H_

#include <istream>
#include <memory>

#include "client/grid/grid_archive.h"

namespace latvox::client {

// Returns whether the file begins like a .nvdb file. The place in `in` is then its begin.
bool IsNanoFile(std::istream& in);

// Opens the grids of a .nvdb file as grids of OpenVDB: their active voxels, transform, class and metadata. Inactive
// values are those of an empty grid. `in` must outlive the archive. ReadGrid also throws std::runtime_error for a grid
// that is neither of bool, float, int32 nor three floats.
std::unique_ptr<GridArchive> OpenNanoArchive(std::istream& in);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_NANO_ARCHIVE_H_
