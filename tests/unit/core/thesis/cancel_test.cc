// The thesis's algorithms end soon when they are cancelled.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "tests/unit/core/job_kinds.h"
#include "tests/unit/core/most_to_stop.h"
#include "tests/unit/core/sphere.h"

namespace latvox {
namespace {

// Before and after the scans they sort edges, voxels and tiles.
TEST(Cancelling, StopsOnManyTrianglesAndOnLargeOnes) {
  const JobKind kind{"", 0, {.algorithm = Algorithm::kOptimizedIncremental}};
  const auto many = [](uint32_t rings) { return Sphere(static_cast<int>(rings), 150); };
  const auto large = [](uint32_t radius) { return Sphere(20, static_cast<float>(radius)); };
  EXPECT_LT(MostToStopJob(300, many, kind), kPromised);
  EXPECT_LT(MostToStopJob(400, large, kind), kPromised);
}

// All triangles have one long edge in common.
TEST(Cancelling, StopsOnAnEdgeOfManyTriangles) {
  const auto book = [](uint32_t pages) {
    TriangleMesh mesh{{{0, 0, 0}, {0, 0, 2000}}, {}};
    for (uint32_t n = 0; n < pages; ++n) {
      const double angle = 6.28 * n / pages;
      mesh.vertices.push_back(
          {static_cast<float>(300 * std::cos(angle)), static_cast<float>(300 * std::sin(angle)), 0});
      mesh.triangles.push_back({0, 1, n + 2});
    }
    return mesh;
  };
  EXPECT_LT(MostToStopJob(2000, book, {"", 0, {.algorithm = Algorithm::kOptimizedIncremental}}), kPromised);
}

// Enough tetrahedra that the stages around the loop over voxels outlast the promise, too.
TEST(Cancelling, StopsBruteForceOnAHeapOfTetrahedra) {
  const auto heap = [](uint32_t tetrahedra) { return HeapOfTetrahedra(tetrahedra); };
  EXPECT_LT(MostToStopJob(8000, heap, {"", 0, {.algorithm = Algorithm::kBruteForce}}), kPromised);
}

}  // namespace
}  // namespace latvox
