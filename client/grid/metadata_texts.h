// The metadata of our grids as text, for files of other formats. Internal to latvox::grid and the tool.
#ifndef LATVOX_CLIENT_GRID_METADATA_TEXTS_H_
#define LATVOX_CLIENT_GRID_METADATA_TEXTS_H_

#include <string>
#include <utility>
#include <vector>

#include "latvox/grid/carried_names.h"
#include "latvox/types.h"

namespace latvox::client {

// Returns names and values in the order of names: those that FieldGrids has of these, without its transform.
std::vector<std::pair<std::string, std::string>> MetadataTexts(const VoxelizeRequest& request, const MeshNote& note,
                                                               const CarriedNames& names, const Summary& summary);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_METADATA_TEXTS_H_
