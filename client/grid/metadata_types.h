// Metadata of our grids from text, with their types. Internal to latvox::grid and the tool.
#ifndef LATVOX_CLIENT_GRID_METADATA_TYPES_H_
#define LATVOX_CLIENT_GRID_METADATA_TYPES_H_

#include <string>
#include <utility>
#include <vector>

#include "client/grid/metadata.h"

namespace latvox::client {

// Returns the metadata latvox_..., whose texts are those of MetadataText, with the types that our grids give these
// names. Other names, and texts that are no values of the type, become texts. Ignores metadata of OpenVDB and other
// programs.
Metadata TypedMetadata(const std::vector<std::pair<std::string, std::string>>& texts);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_METADATA_TYPES_H_
