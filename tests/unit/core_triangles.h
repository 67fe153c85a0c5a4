// Triangles around a tile, for the tests of the kernels.
#ifndef LATVOX_TESTS_UNIT_CORE_TRIANGLES_H_
#define LATVOX_TESTS_UNIT_CORE_TRIANGLES_H_

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <random>
#include <vector>

#include "core/digitize/crossing.h"
#include "core/digitize/principal_scan.h"
#include "core/snap/corner_list.h"
#include "core/snap/snap.h"

namespace latvox {

inline constexpr unsigned kSeed = 7;

inline SnappedMesh MeshOf(const std::vector<Triangle>& triangles) {
  SnappedMesh mesh{};
  std::vector<std::array<uint32_t, 3>> indices;
  for (const Triangle& triangle : triangles) {
    const auto n = static_cast<uint32_t>(mesh.vertices_lat.size());
    mesh.vertices_lat.insert(mesh.vertices_lat.end(), triangle.begin(), triangle.end());
    indices.push_back({n, n + 1, n + 2});
  }
  mesh.triangles = std::move(indices);
  return mesh;
}

inline std::vector<uint32_t> Iota(size_t size) {
  std::vector<uint32_t> numbers(size);
  for (uint32_t n = 0; n < size; ++n) numbers[n] = n;
  return numbers;
}

// Calls f(CornerList&) for all triangles, list after list.
template <class F>
void ForEachList(const SnappedMesh& mesh, F&& f) {
  const auto list = std::make_unique<CornerList>();
  ForEachList(mesh, 0, mesh.triangles.size(), *list, [&] { f(*list); });
}

inline Vec3i ReachOf(const std::vector<ScanFrame>& frames) {
  Vec3i reach{};
  for (const ScanFrame& scan : frames) {
    for (size_t m = 0; m < 3; ++m) reach[m] = std::max(reach[m], std::abs(scan.frame.q[m]));
  }
  return reach;
}

// Triangles of a given size around a tile, a third of them with corners on multiples of a quarter voxel, where ties
// are.
inline std::vector<Triangle> TrianglesAround(const Vec3i& tile_min, int32_t size, size_t count) {
  std::mt19937 random(kSeed);
  std::uniform_int_distribution<int32_t> place(-8 * kLatticeUnit, 72 * kLatticeUnit), side(-size, size);
  std::vector<Triangle> triangles;
  for (size_t n = 0; n < count; ++n) {
    Triangle triangle;
    Vec3i at;
    for (int32_t& x : at) x = place(random);
    for (size_t v = 0; v < 3; ++v) {
      for (size_t m = 0; m < 3; ++m) {
        const int32_t x = tile_min[m] * kLatticeUnit + at[m] + side(random);
        triangle[v][m] = n % 3 == 0 ? x & ~(kLatticeUnit / 4 - 1) : x;
      }
    }
    if (n % 2 == 0)
      triangle[2] = (tile_min * kLatticeUnit + at) * 3 - triangle[0] - triangle[1];  // its middle is there
    if (n % 17 == 0) triangle[2] = triangle[n % 2];
    triangles.push_back(triangle);
  }
  return triangles;
}

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_CORE_TRIANGLES_H_
