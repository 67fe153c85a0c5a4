// Random triangles, and their supercover triangle by triangle and row by row, which supercover_test.cc compares with
// exact clipping.
#ifndef LATVOX_TESTS_UNIT_CORE_SUPERCOVER_ROW_BY_ROW_H_
#define LATVOX_TESTS_UNIT_CORE_SUPERCOVER_ROW_BY_ROW_H_

#include <random>
#include <set>

#include "core/supercover/supercover.h"
#include "tests/unit/core/exact.h"

namespace latvox {

// Corners are multiples of `grain` lattice units below `extent`.
inline oracle::Mesh RandomTriangles(int64_t grain, int64_t extent, size_t count, std::mt19937& random) {
  oracle::Mesh mesh(count);
  for (oracle::Triangle& triangle : mesh) {
    oracle::Int3 corner;
    for (int64_t& x : corner) x = static_cast<int64_t>(random() % 20000) / grain * grain;
    for (oracle::Int3& v : triangle) {
      for (size_t m = 0; m < 3; ++m) {
        v[m] = corner[m] + grain * static_cast<int64_t>(random() % static_cast<uint64_t>(extent / grain));
      }
    }
  }
  return mesh;
}

inline Triangle FromOracle(const oracle::Triangle& triangle) {
  Triangle out;
  for (size_t n = 0; n < 3; ++n) {
    for (size_t m = 0; m < 3; ++m) out[n][m] = static_cast<int32_t>(triangle[n][m]);
  }
  return out;
}

inline std::set<oracle::Int3> RowByRow(const oracle::Mesh& mesh, const Lattice& lattice) {
  constexpr int32_t kFar = 1 << 20;
  const Supercover supercover(IntegerCell::Of(lattice).value());
  std::set<oracle::Int3> voxels;
  for (const oracle::Triangle& triangle : mesh) {
    supercover.ForEachRun(FromOracle(triangle), {{-kFar, -kFar, -kFar}, {kFar, kFar, kFar}},
                          [&](const Vec3i& first, int32_t count) {
                            for (int32_t n = 0; n < count; ++n) voxels.insert({first[0], first[1], first[2] + n});
                          });
  }
  return voxels;
}

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_CORE_SUPERCOVER_ROW_BY_ROW_H_
