// Pictures of pixel sets.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_PIXEL_PICTURE_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_PIXEL_PICTURE_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/tool/curve/curve_file.h"
#include "client/tool/output/picture_style.h"
#include "latvox/plane_types.h"

namespace latvox::client {

inline constexpr int kPixelPictureSide = 1024;  // samples of the longer side

// Returns the bytes of a PNG file, kPixelPictureSide samples on its longer side: every pixel as its Voronoi cell, a
// rectangle or a hexagon, under the curve. Errors: INTERNAL (libpng).
absl::StatusOr<std::string> DrawPixels(const Drawing& drawing, const Pixelization& pixelization);

inline constexpr uint32_t kCellColor = 0x99B5D9;

struct PictureCell {
  Vec2i ij;
  uint32_t color = kCellColor;  // as in client/tool/output/voxel_colors.h
  bool inside = false;          // a black line separates inside from outside cells
};

// Draws without a curve, at another size, the part of the world within `low` and `high`.
absl::StatusOr<std::string> DrawCells(const PlaneTransform& grid, const std::vector<PictureCell>& cells,
                                      const Vec2d& low, const Vec2d& high, int longer_side, const PictureStyle& style);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_PIXEL_PICTURE_H_
