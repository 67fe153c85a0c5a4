// The names of the metadata that hold the names of parts and materials. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_NAMES_KEYS_H_
#define LATVOX_CLIENT_GRID_NAMES_KEYS_H_

#include <utility>

#include "latvox/types.h"

namespace latvox::client {

inline constexpr std::pair<Field, const char*> kNamesKeys[] = {{Field::kPart, "latvox_part_names"},
                                                               {Field::kMaterial, "latvox_material_names"}};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_NAMES_KEYS_H_
