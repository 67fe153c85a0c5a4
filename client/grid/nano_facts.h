// Facts in a grid of a .nvdb file. Includes NanoVDB's headers, but none of OpenVDB. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_NANO_FACTS_H_
#define LATVOX_CLIENT_GRID_NANO_FACTS_H_

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "client/grid/nano_names.h"
#include "latvox/types.h"

namespace latvox::client {

inline constexpr uint64_t kMostNanoText = uint64_t{1} << 20;  // bytes of a grid's name, or of its metadata
inline constexpr char kNanoBlindName[] = "latvox";            // of the blind data that hold the metadata

GridTransform NanoTransform(const nanovdb::GridData& grid);

// Reads bytes at this place within a grid. Returns whether they are there.
using ReadNanoBytes = std::function<bool(uint64_t at, void* to, uint64_t bytes)>;

// Returns the metadata that WriteNanoFile writes: its lines "name = value". Other programs' blind data have none.
std::vector<std::pair<std::string, std::string>> NanoMetadata(const nanovdb::GridData& grid, const ReadNanoBytes& read);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_NANO_FACTS_H_
