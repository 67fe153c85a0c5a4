// Triangles around a tile, for the tests of the kernels.
#ifndef LATVOX_TESTS_UNIT_CORE_TRIANGLES_H_
#define LATVOX_TESTS_UNIT_CORE_TRIANGLES_H_

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <numeric>
#include <random>
#include <vector>

#include "core/digitize/crossing.h"
#include "core/digitize/principal_scan.h"
#include "core/snap/snap.h"
#include "core/triangles/corner_list.h"
#include "core/triangles/surface_facts.h"
#include "tests/unit/dose.h"

namespace latvox {

inline constexpr unsigned kSeed = 7;

inline SnappedMesh MeshOf(const std::vector<Triangle>& triangles) {
  PaddedVector<Vec3i> vertices_lat;
  std::vector<std::array<uint32_t, 3>> indices;
  for (const Triangle& triangle : triangles) {
    const auto n = static_cast<uint32_t>(vertices_lat.size());
    vertices_lat.insert(vertices_lat.end(), triangle.begin(), triangle.end());
    indices.push_back({n, n + 1, n + 2});
  }
  return {{}, std::move(vertices_lat), std::move(indices), {}};
}

inline std::vector<uint32_t> Iota(size_t size) {
  std::vector<uint32_t> numbers(size);
  for (uint32_t n = 0; n < size; ++n) numbers[n] = n;
  return numbers;
}

// Calls f(CornerList&) for all triangles, list after list.
template <class F>
void ForEachList(const SnappedMesh& mesh, const Vec3i& origin, F&& f) {
  const auto list = std::make_unique<CornerList>();
  const size_t count = mesh.triangles.size();
  for (size_t first = 0; first < count; first += CornerList::kMost) {
    SurfaceSums().AddAndList(mesh, first, std::min(CornerList::kMost, count - first), origin, *list);
    f(*list);
  }
}

inline Vec3i ReachOf(const std::vector<ScanFrame>& frames) {
  Vec3i reach{};
  for (const ScanFrame& scan : frames) {
    for (size_t m = 0; m < 3; ++m) reach[m] = std::max(reach[m], std::abs(scan.frame.q[m]));
  }
  return reach;
}

// Triangles of a given size around a tile. A third of them have corners on multiples of a quarter voxel, where ties
// occur.
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

// Large triangles. Nearly all of their lattice lines are hard to round. Some have planes that are parallel to axes, or
// nearly so, next to ties of depths. Others are slivers with an area of 3/2 lattice units and a lattice point on their
// longest edge.
inline std::vector<Triangle> LargeAndClose(const Vec3i& tile_min) {
  std::mt19937 random(kSeed);
  const auto among = [&](int32_t least, int32_t most) {
    return std::uniform_int_distribution<int32_t>(least, most)(random);
  };
  std::vector<Triangle> triangles;
  const auto add = [&](Triangle triangle) {
    const Vec3i at = (tile_min + Vec3i{among(0, 63), among(0, 63), among(0, 63)}) * kLatticeUnit;
    const auto first = static_cast<size_t>(among(0, 2));  // which axis x is
    for (Vec3i& v : triangle) v = at + Vec3i{v[first], v[(first + 1) % 3], v[(first + 2) % 3]};
    if (among(0, 1) == 0) std::swap(triangle[0], triangle[1]);
    triangles.push_back(triangle);
  };
  for (const int32_t size : {1 << 15, 1 << 21}) {
    for (const int32_t most : {0, 1, 40}) {
      for (int n = 0; n < Dose(8, 2); ++n) {
        const int32_t z = among(0, 1) * kLatticeUnit / 2;
        add({{{-among(1, size), -among(1, size), z + among(-most, most)},
              {among(1, size), -among(1, size), z + among(-most, most)},
              {among(-size, size), among(1, size), z + among(-most, most)}}});
      }
    }
  }
  for (int n = 0; n < Dose(20, 5); ++n) {
    constexpr int32_t kFar = kMaxExtent * kLatticeUnit / 2 - 1, kNear = 1 << 13;
    add({{{-among(0, kNear), -among(0, kNear), among(-kNear, kNear)},
          {among(kFar / 2, kFar), among(-kFar, kFar), among(-kFar, kFar)},
          {among(-kFar, kFar), among(kFar / 2, kFar), among(-kFar, kFar)}}});
  }
  for (int n = 0; n < Dose(40, 10); ++n) {
    // Corners at -u, 2u and w - u, with det(u, w) = 1; in z, planes of slope -1, 0 or 1.
    Vec<int64_t, 2> u{among(1 << 13, 1 << 15), among(1 << 13, 1 << 15)}, w{};
    while (std::gcd(u[0], u[1]) != 1) ++u[1];
    while ((u[0] * w[1] - 1) % u[1] != 0) ++w[1];
    w[0] = (u[0] * w[1] - 1) / u[1];
    const int32_t over_x = among(-1, 1), over_y = among(-1, 1), z = among(0, kLatticeUnit);
    const auto corner = [&](const Vec<int64_t, 2>& p) {
      const auto x = static_cast<int32_t>(p[0]), y = static_cast<int32_t>(p[1]);
      return Vec3i{x, y, z + over_x * x + over_y * y};
    };
    add({corner(-u), corner(u + u), corner(w - u)});
  }
  return triangles;
}

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_CORE_TRIANGLES_H_
