// Linear colors, and sRGB colors of files.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_SRGB_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_SRGB_H_

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace latvox::client {

inline float ToLinear(uint8_t level) { return std::pow(static_cast<float>(level) / 255, 2.2F); }

inline uint8_t ToLevel(float linear) {
  return static_cast<uint8_t>(std::pow(std::clamp(linear, 0.0F, 1.0F), 1 / 2.2F) * 255 + 0.5F);
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_SRGB_H_
