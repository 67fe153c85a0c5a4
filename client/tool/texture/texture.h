// Means of an image.
#ifndef LATVOX_CLIENT_TOOL_TEXTURE_TEXTURE_H_
#define LATVOX_CLIENT_TOOL_TEXTURE_TEXTURE_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "client/mesh/base_colors.h"
#include "client/tool/texture/decode_image.h"

namespace latvox::client {

// A part of an axis of an image: its center and length in units of the image, whose pixels lie in 0 to 1.
struct Interval {
  double center = 0, length = 0;
};

// An image and smaller images of it, which are made when they are first needed. Not thread-safe.
//
// A mean over a rectangle is exact where the rectangle covers at most kMostTexels pixels. Larger ones are taken from
// the image at half, a quarter, ... of the resolution. Each pixel of a smaller image is the mean of the pixels below
// it. So only pixels at the rim of the rectangle, less than 1/8 of its sides, are taken to be uniform. Pixels that go
// on beyond a clamped edge are taken to be uniform, too. All of this is linear.
class Texture {
 public:
  static constexpr double kMostTexels = 256;

  explicit Texture(Pixels pixels);

  // Returns the mean over a rectangle. A side is at least one pixel long if `is_smooth`: where pixels are larger than
  // the rectangle, this is their bilinear interpolation.
  LinearRgba Mean(Interval u, Interval v, const std::array<Wrap, 2>& wraps, bool is_smooth);

 private:
  struct Level {
    uint32_t width = 0, height = 0;
    std::vector<LinearRgba> texels = {};
  };

  void AddLevel();
  const LinearRgba& At(size_t level, uint32_t x, uint32_t y);
  uint32_t WidthOf(size_t level) const { return level == 0 ? pixels_.width : levels_[level - 1].width; }
  uint32_t HeightOf(size_t level) const { return level == 0 ? pixels_.height : levels_[level - 1].height; }

  const Pixels pixels_;
  std::vector<Level> levels_;  // from half the resolution on, down to one pixel
  LinearRgba pixel_{};         // what At returned last of pixels_
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_TEXTURE_TEXTURE_H_
