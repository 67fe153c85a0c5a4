// Colors between linear intensities and sRGB.
#ifndef LATVOX_CLIENT_MESH_SRGB_H_
#define LATVOX_CLIENT_MESH_SRGB_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "client/mesh/mesh.h"

namespace latvox::client {

using LinearColor = std::array<double, 3>;  // red, green, blue; 1 is full intensity

// Converts linear intensities, clamped to 0 and 1, to the nearest bytes of sRGB.
inline Color ToSrgb(const LinearColor& linear) {
  Color bytes;
  for (size_t n = 0; n < 3; ++n) {
    const double c = std::min(std::max(0.0, linear[n]), 1.0);
    const double encoded = c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
    bytes[n] = static_cast<uint8_t>(std::nearbyint(encoded * 255));
  }
  return bytes;
}

// Returns the linear intensity of a byte of sRGB, 0 to 1.
inline double ToLinear(uint8_t byte) {
  const double c = byte / 255.0;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_SRGB_H_
