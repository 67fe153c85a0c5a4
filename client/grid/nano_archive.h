// The grids of a .nvdb file, read from a stream. Includes OpenVDB's headers. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_NANO_ARCHIVE_H_
#define LATVOX_CLIENT_GRID_NANO_ARCHIVE_H_

#include <istream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "client/grid/grid_archive.h"
#include "client/grid/nano_names.h"

namespace latvox::client {

// Opens the grids of a .nvdb file as grids of OpenVDB: their active voxels, transform, class and metadata. Inactive
// values are those of an empty grid. `in` must outlive the archive. ReadGrid also throws std::runtime_error for a grid
// that is neither of bool, float, int32 nor three floats.
std::unique_ptr<GridArchive> OpenNanoArchive(std::istream& in);

// Gives a grid of OpenVDB the name, transform, class and metadata of a grid of a .nvdb file.
void DescribeNano(const std::string& name, const nanovdb::GridData& data,
                  const std::vector<std::pair<std::string, std::string>>& metadata, openvdb::GridBase& grid);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_NANO_ARCHIVE_H_
