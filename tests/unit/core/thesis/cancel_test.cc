// The thesis's algorithms end soon when they are cancelled.
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/stop_signal.h"
#include "core/lattice/lattice.h"
#include "core/thesis/neighborhood.h"
#include "core/thesis/seams.h"
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

// All triangles have one long edge in common. It is scanned alone, because the triangles take far longer than the edge.
using Normals = std::vector<Vec<int64_t, 3>>;

struct EdgeScan {
  const Normals& normals;
  StopSource source;

  void Run() {
    const Neighborhood neighborhood(Lattice::Named(NamedLattice::kCartesian), 0);
    Seam({0, 0, 0}, {0, 0, 2000}, normals, neighborhood, source.Signal(), [](const Vec3i&) {});
  }
  void Cancel() { source.Stop(); }
};

TEST(Cancelling, StopsOnAnEdgeOfManyTriangles) {
  const auto book = [](uint32_t pages) {
    Normals normals;
    for (uint32_t n = 0; n < pages; ++n) normals.push_back({n + 1, pages - n, 0});
    return normals;
  };
  const auto scan = [](const Normals& normals) { return std::unique_ptr<EdgeScan>(new EdgeScan{normals, {}}); };
  EXPECT_LT(MostToStop(100000, book, scan), kPromised);
}

// Enough tetrahedra that the stages around the loop over voxels outlast the promise, too.
TEST(Cancelling, StopsBruteForceOnAHeapOfTetrahedra) {
  const auto heap = [](uint32_t tetrahedra) { return HeapOfTetrahedra(tetrahedra); };
  EXPECT_LT(MostToStopJob(8000, heap, {"", 0, {.algorithm = Algorithm::kBruteForce}}), kPromised);
}

}  // namespace
}  // namespace latvox
