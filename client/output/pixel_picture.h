// Pictures of pixel sets.
#ifndef LATVOX_CLIENT_OUTPUT_PIXEL_PICTURE_H_
#define LATVOX_CLIENT_OUTPUT_PIXEL_PICTURE_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/curve/curve_file.h"
#include "client/plane_types.h"

namespace latvox::client {

inline constexpr int kPixelPictureSide = 1024;  // samples, of the longer one

// The bytes of a PNG file, kPixelPictureSide samples on its longer side: every pixel as its Voronoi cell, a rectangle
// or a hexagon, and the curve over it. Errors: INTERNAL (libpng).
absl::StatusOr<std::string> DrawPixels(const Drawing& drawing, const Pixelization& pixelization);

// The same without a curve, of another size: what is within `low` and `high`, world coordinates.
absl::StatusOr<std::string> DrawCells(const PlaneTransform& grid, const std::vector<Vec2i>& cells, const Vec2d& low,
                                      const Vec2d& high, int longer_side);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_OUTPUT_PIXEL_PICTURE_H_
