// Colors of voxels by their fields.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_VOXEL_COLORS_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_VOXEL_COLORS_H_

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "latvox/grid/grid_content.h"
#include "latvox/types.h"
#include "latvox/warning.h"

namespace latvox::client {

// A color is a number: red << 16 | green << 8 | blue, sRGB. After kNone, one for each field, in the order of kFields.
enum class ColorBy {
  kNone,
  kPart,
  kMaterial,
  kColor,
  kDistance,
  kTriangle,
  kPoint,
  kNormal,
  kLinks,
  kLinkTriangles,
  kLinkCrossings,
  kFraction,
  kLabelFractions
};

// Returns "none", or the name of the field.
const char* NameOf(ColorBy by);

// Returns the colors that a field gives: every field has some.
ColorBy ByOf(Field field);

// The fields that voxels carry. GridContent has those of a file.
struct VoxelTraits {
  std::vector<Field> fields = {};
  std::optional<DistanceRange> distances = std::nullopt;  // absent: distances give no colors
  uint32_t points_of_cell = 0;                            // the greatest fraction; 0: no fractions give colors
};

// Returns those of a file.
VoxelTraits TraitsOf(const GridContent& content);

// Returns the default: colors, otherwise materials, otherwise parts, otherwise distances, otherwise none.
ColorBy DefaultColorBy(const VoxelTraits& traits);

// Returns the color of a part, material or triangle: one of twelve that color-blind people can tell apart, then the
// first again.
uint32_t PaletteColor(uint32_t number);

// Returns the color of a distance. A signed one is blue inside, white at the surface, red outside: ColorBrewer's RdBu.
// An unsigned one goes from dark violet at the surface to yellow: viridis. Both are safe for color-blind people and end
// at the ends of the range.
uint32_t DistanceColor(float distance, const DistanceRange& range);

// Returns one number for each voxel: the least share, the smallest triangle or the most crossings of its crossed links.
// A voxel without such a link has the value of an uncrossed one.
FieldValues OneOfLinks(const FieldValues& links);

// Returns whether the number, of OneOfLinks, tells that no link is crossed.
bool IsUncrossed(ColorBy by, uint32_t number);

// Returns the color of a number of a field of integers. A color stays as it is. Other numbers get PaletteColor, or gray
// if no link is crossed.
uint32_t ColorOfNumber(ColorBy by, uint32_t number);

// Returns the color of a share of a link or a cell: viridis from 0 to 1. NaN, for no crossed link, is gray.
uint32_t ShareColor(double share);

// Returns the color of a fraction: viridis from 0 to the number of points of a cell.
uint32_t FractionColor(uint32_t fraction, uint32_t points_of_cell);

// Returns the color of a cell that several labels share: the mean of their palette's colors, weighted by their points.
// Points that have none of these labels are white.
//   points   of each label
uint32_t BlendedColor(std::span<const uint32_t> labels, std::span<const uint16_t> points, uint32_t points_of_cell);

// Returns the color of a normal: each component from -1 to 1 becomes red, green or blue from 0 to 255.
uint32_t NormalColor(const std::array<float, 3>& normal);

// Returns the color of the weights of a triangle's corners: red, green and blue from 0 to 1.
uint32_t WeightsColor(const std::array<float, 3>& weights);

// Returns the number of a part, material or color for each voxel of the batch, in order; none for ColorBy::kNone.
// ColorOfNumber gives its color. Errors: as ColorsOf.
absl::StatusOr<std::vector<uint32_t>> NumbersOf(const BrickBatch& batch, ColorBy by);

// Returns the warning COLORS_MERGED if a file has fewer colors than its voxels have such numbers.
std::optional<Warning> WarningOfMergedColors(const std::string& path, ColorBy by, size_t numbers, size_t colors);

// Returns a color for each voxel of the batch, in order; none for ColorBy::kNone. Errors: INVALID_ARGUMENT: the voxels
// have no values of that name.
absl::StatusOr<std::vector<uint32_t>> ColorsOf(const BrickBatch& batch, const VoxelTraits& traits, ColorBy by);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_VOXEL_COLORS_H_
