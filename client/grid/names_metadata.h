// The names of parts and materials in the metadata of our grids. Internal to latvox::grid and the tool.
#ifndef LATVOX_CLIENT_GRID_NAMES_METADATA_H_
#define LATVOX_CLIENT_GRID_NAMES_METADATA_H_

#include "client/grid/metadata.h"
#include "latvox/grid/carried_names.h"

namespace latvox::client {

// The most names of an attribute that metadata keep: those of the lowest numbers.
inline constexpr size_t kMostNames = 10'000;

// Returns the names of an attribute as metadata, or nothing if there are none.
Metadata NamesMetadata(const CarriedNames& names, Field attribute);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_NAMES_METADATA_H_
