// Pictures in memory.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_IMAGE_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_IMAGE_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace latvox::client {

using Rgb8 = std::array<uint8_t, 3>;  // sRGB

inline Rgb8 ToRgb8(uint32_t color) {
  return {static_cast<uint8_t>(color >> 16), static_cast<uint8_t>(color >> 8), static_cast<uint8_t>(color)};
}

// Red, green, blue and opacity of each pixel; rows from the top. Colors are not multiplied by the opacity.
class Image {
 public:
  Image(int width, int height)  // transparent
      : width_(width), height_(height), rgba_(4 * static_cast<size_t>(width) * static_cast<size_t>(height)) {}

  int width() const { return width_; }
  int height() const { return height_; }
  const std::vector<uint8_t>& rgba() const { return rgba_; }
  uint8_t* At(int x, int y) { return &rgba_[Place(x, y)]; }
  const uint8_t* At(int x, int y) const { return &rgba_[Place(x, y)]; }

  // Paints a color over a pixel, with this opacity from 0 to 1.
  void PaintOver(int x, int y, const Rgb8& color, float opacity) {
    uint8_t* const pixel = At(x, y);
    const float under = static_cast<float>(pixel[3]) / 255 * (1 - opacity), sum = opacity + under;
    if (sum <= 0) return;
    for (size_t m = 0; m < 3; ++m) {
      const float mixed = (static_cast<float>(color[m]) * opacity + static_cast<float>(pixel[m]) * under) / sum;
      pixel[m] = static_cast<uint8_t>(mixed + 0.5F);
    }
    pixel[3] = static_cast<uint8_t>(sum * 255 + 0.5F);
  }

 private:
  size_t Place(int x, int y) const {
    return 4 * (static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x));
  }

  int width_, height_;
  std::vector<uint8_t> rgba_;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_IMAGE_H_
