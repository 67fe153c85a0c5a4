// Warnings in the metadata of our grids. Internal to latvox::grid and the tool.
#ifndef LATVOX_CLIENT_GRID_WARNING_METADATA_H_
#define LATVOX_CLIENT_GRID_WARNING_METADATA_H_

#include <string>
#include <vector>

#include "client/grid/metadata.h"
#include "latvox/warning.h"

namespace latvox::client {

inline constexpr char kWarningsName[] = "latvox_warnings";

// Returns the warnings as JSON, or nothing if there are none.
Metadata WarningMetadata(const std::vector<Warning>& warnings);

// Returns the JSON of all different warnings in several such texts, in their order; empty if there are none. Leaves out
// EMPTY_RESULT and EMPTY_SHARD, because parts are joined. Returns nothing for a text that is not JSON.
std::string JoinedWarnings(const std::vector<std::string>& texts);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_WARNING_METADATA_H_
