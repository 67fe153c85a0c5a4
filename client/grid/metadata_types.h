// Metadata of our grids from text, with their types. Includes OpenVDB's headers. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_METADATA_TYPES_H_
#define LATVOX_CLIENT_GRID_METADATA_TYPES_H_

#include <string>
#include <utility>
#include <vector>

#include "client/grid/openvdb_trees.h"

namespace latvox::client {

// Writes the metadata latvox_..., whose texts are those of MetadataText, with the types that our grids give these
// names. Other names, and texts that are no values of the type, become texts. Ignores metadata of OpenVDB and other
// programs.
void InsertTexts(const std::vector<std::pair<std::string, std::string>>& metadata, openvdb::GridBase& grid);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_METADATA_TYPES_H_
