// A mesh that pipelines' tests share.
#ifndef LATVOX_TESTS_UNIT_CORE_SPHERE_H_
#define LATVOX_TESTS_UNIT_CORE_SPHERE_H_

#include <cmath>
#include <cstdint>

#include "core/mesh/mesh.h"

namespace latvox {

// A bumpy sphere: `rings` x 2 `rings` quads, radius in world units.
inline TriangleMesh Sphere(int rings, float radius) {
  TriangleMesh mesh;
  const auto vertex = [&](int ring, int segment) {
    const double theta = M_PI * ring / rings, phi = M_PI * segment / rings;
    const double r = radius * (1 + 0.1 * std::sin(5 * theta) * std::cos(4 * phi));
    return Vec3f{static_cast<float>(r * std::sin(theta) * std::cos(phi)),
                 static_cast<float>(r * std::sin(theta) * std::sin(phi)), static_cast<float>(r * std::cos(theta))};
  };
  for (int ring = 0; ring < rings; ++ring) {
    for (int segment = 0; segment < 2 * rings; ++segment) {
      const auto n = static_cast<uint32_t>(mesh.vertices.size());
      const int next = (segment + 1) % (2 * rings);
      for (const Vec3f& p :
           {vertex(ring, segment), vertex(ring + 1, segment), vertex(ring + 1, next), vertex(ring, next)}) {
        mesh.vertices.push_back(p);
      }
      mesh.triangles.push_back({n, n + 1, n + 2});
      mesh.triangles.push_back({n, n + 2, n + 3});
    }
  }
  return mesh;
}

// The canonical order of tiles, bit by bit.
inline uint64_t Morton(const Vec3i& relative) {
  uint64_t code = 0;
  for (int bit = 20; bit >= 0; --bit) {
    for (int32_t x : relative) code = code << 1 | static_cast<uint64_t>(x >> bit & 1);
  }
  return code;
}

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_CORE_SPHERE_H_
