// Affine maps of positions.
#ifndef LATVOX_CLIENT_MESH_AFFINE_H_
#define LATVOX_CLIENT_MESH_AFFINE_H_

#include <array>

#include "client/mesh/mesh.h"

namespace latvox::client {

// Row-major; the fourth row is (0, 0, 0, 1).
using Affine = std::array<std::array<double, 4>, 3>;

inline constexpr Affine kIdentity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

constexpr Affine Scaling(double s) { return {{{s, 0, 0, 0}, {0, s, 0, 0}, {0, 0, s, 0}}}; }

// `inner` first, then `outer`.
inline Affine operator*(const Affine& outer, const Affine& inner) {
  Affine out{};
  for (size_t r = 0; r < 3; ++r) {
    for (size_t c = 0; c < 4; ++c) {
      out[r][c] = c == 3 ? outer[r][3] : 0;
      for (size_t m = 0; m < 3; ++m) out[r][c] += outer[r][m] * inner[m][c];
    }
  }
  return out;
}

inline Vec3d Apply(const Affine& map, const Vec3d& v) {
  // Unchanged, so that positions without a transform keep their bits.
  if (map == kIdentity) return v;
  Vec3d out;
  for (size_t r = 0; r < 3; ++r) out[r] = map[r][0] * v[0] + map[r][1] * v[1] + map[r][2] * v[2] + map[r][3];
  return out;
}

// Returns whether the map turns the orientation of triangles around.
inline bool Mirrors(const Affine& map) {
  const auto& [a, b, c] = map;
  return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]) <
         0;
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_AFFINE_H_
