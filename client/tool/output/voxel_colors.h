// Colors of voxels, by what they have besides their places.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_VOXEL_COLORS_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_VOXEL_COLORS_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "latvox/types.h"

namespace latvox::client {

// A color is a number, as Attribute has it: red << 16 | green << 8 | blue, sRGB.
enum class ColorBy { kNone, kPart, kMaterial, kColor, kDistance };

// "none", "part", "material", "color" or "distance".
const char* NameOf(ColorBy by);

// What voxels have; GridContent has it of a file.
struct VoxelTraits {
  std::vector<Attribute> attributes = {};
  std::optional<Band> band = std::nullopt;  // with its width in world units
};

// What voxels are colored by unless somebody says: their colors, else materials, else parts, else distances.
ColorBy DefaultColorBy(const VoxelTraits& traits);

// Of parts and materials: twelve colors, which color-blind people tell apart, too; then the first again.
uint32_t PaletteColor(uint32_t number);

// Of a signed band, blue inside, white at the surface, red outside: ColorBrewer's RdBu. Of another, from dark violet at
// the surface to yellow: viridis. Both are safe for color-blind people, and end at the band's width.
uint32_t DistanceColor(float distance, const Band& band);

// A color for each voxel of the batch, in the order of its numbers; none by ColorBy::kNone.
// Errors: INVALID_ARGUMENT: the voxels have nothing of that name.
absl::StatusOr<std::vector<uint32_t>> ColorsOf(const BrickBatch& batch, const VoxelTraits& traits, ColorBy by);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_VOXEL_COLORS_H_
