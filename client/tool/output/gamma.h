// Levels of pictures, 0 to 255, and linear intensities: a power of 2.2, which is close to sRGB for what is drawn.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_GAMMA_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_GAMMA_H_

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace latvox::client {

inline float IntensityOf(uint8_t level) { return std::pow(static_cast<float>(level) / 255, 2.2F); }

inline uint8_t LevelOf(float intensity) {
  return static_cast<uint8_t>(std::pow(std::clamp(intensity, 0.0F, 1.0F), 1 / 2.2F) * 255 + 0.5F);
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_GAMMA_H_
