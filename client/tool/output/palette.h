// Palettes for formats that number their colors.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_PALETTE_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_PALETTE_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "absl/container/flat_hash_map.h"

namespace latvox::client {

// Colors are numbers, as in client/tool/output/voxel_colors.h.
struct Palette {
  std::vector<uint32_t> colors;                       // each one once, in ascending order if no color was reduced
  absl::flat_hash_map<uint32_t, uint32_t> number_of;  // a given color to its place in `colors`
};

// Returns a palette of at most `most` colors, which is at least 1. It is exact if there are no more different ones.
// Otherwise median cut (P. Heckbert, "Color image quantization for frame buffer display", 1982) reduces them. Equal
// colors in another order give the same palette.
Palette PaletteOf(std::span<const uint32_t> colors, size_t most);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_PALETTE_H_
