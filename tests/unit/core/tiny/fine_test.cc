// Meshes of triangles smaller than voxels take another path through the pipeline. Their voxels equal those of plain
// C++, which treats no triangle as tiny.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/block/tile_job.h"
#include "core/tiny/fineness.h"
#include "core/triangles/surface_facts.h"
#include "core/voxelizer/voxelizer.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/sphere.h"
#include "tests/unit/dose.h"

namespace latvox {
namespace {

TriangleMesh FineSphere() { return Sphere(120, 28); }

// A sphere of small triangles, heaps of many more on borders of tiles, where thinning is hardest, and a few large
// triangles through all of it.
TriangleMesh FineMesh(size_t heaped) {
  TriangleMesh mesh = FineSphere();
  std::mt19937 random(11);
  std::uniform_real_distribution<float> any(-1, 1);
  const auto add = [&](const Vec3f& middle, float size) {
    const auto n = static_cast<uint32_t>(mesh.vertices.size());
    for (int corner = 0; corner < 3; ++corner) {
      mesh.vertices.push_back(
          {middle[0] + size * any(random), middle[1] + size * any(random), middle[2] + size * any(random)});
    }
    mesh.triangles.push_back({n, n + 1, n + 2});
  };
  for (size_t n = 0; n < heaped; ++n) {
    const Vec3f heap = n % 2 == 0 ? Vec3f{0, 0, 0} : Vec3f{-64, 10, 20};
    add({heap[0] + 5 * any(random), heap[1] + 20 * any(random), heap[2] + 5 * any(random)}, 0.6F);
  }
  for (int n = 0; n < 20; ++n) add({30 * any(random), 30 * any(random), 30 * any(random)}, 40);
  return mesh;
}

struct Case {
  std::string name;
  VoxelizeOptions options;
};

TEST(FineMeshes, HaveTheSameVoxelsOnAllKernelsAndThreads) {
  const TriangleMesh mesh = FineMesh(Dose<size_t>(6000, 2000));
  const TriangleMesh closed = FineSphere();
  for (const ExactLattice& l : ExactLattices()) {
    const Grid grid = Unscaled(l.lattice);
    for (const int k : {0, 2}) {
      const auto frames = l.lattice.frames(k);
      const SnappedMesh snapped = *Snap(mesh, l.lattice, grid.origin, ReachOf(frames));
      ASSERT_TRUE(FinenessOf(snapped, MakeScanFrames(frames)).most_tiny) << l.name << " k " << k;
      std::vector<Case> cases{{"minimal", {.separability = k}}, {"not minimal", {.separability = k, .minimal = false}}};
      if (!kSlowed) {
        cases.push_back({"region", {.separability = k, .region = IndexBox{{-20, -30, -7}, {9, 40, 70}}}});
        cases.push_back({"bounds", {.separability = k, .bounds = Bounds{{-20, -30, -10}, {50, 41, 22}}}});
        cases.push_back({"shard", {.separability = k, .shard = Shard{1, 3}}});
        cases.push_back({"solid", {.separability = k, .set = Solid{}}});
      }
      for (const Case& c : cases) {
        SCOPED_TRACE(absl::StrCat(l.name, " k ", k, " ", c.name));
        const TriangleMesh& of = std::holds_alternative<Solid>(c.options.set) ? closed : mesh;
        std::string expected;
        for (const Simd simd : SimdHere()) {
          const ForcedSimd forced(simd);
          const int threads = simd == Simd::kBest ? 3 : 1;
          const std::string digest = Voxelize(of, grid, c.options, threads).totals.digest.ToHex();
          if (expected.empty()) expected = digest;  // of plain C++, which comes first
          EXPECT_EQ(digest, expected) << SimdInUse();
        }
      }
    }
  }
}

// Triangles of a third of a voxel, in two cubes with a gap between.
TriangleMesh Dust(float side, float gap) {
  TriangleMesh mesh;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> any(0, 1);
  for (uint32_t n = 0; n < 3 * 20000; n += 3) {
    const float from = n % 2 == 0 ? 0 : side + gap;
    const Vec3f middle{from + side * any(random), from + side * any(random), from + side * any(random)};
    for (int corner = 0; corner < 3; ++corner) {
      mesh.vertices.push_back({middle[0] + any(random) / 3, middle[1] + any(random) / 3, middle[2] + any(random) / 3});
    }
    mesh.triangles.push_back({n, n + 1, n + 2});
  }
  return mesh;
}

TEST(FineMeshes, AreThoseWithManyTrianglesInEachTile) {
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  const auto frames = grid.lattice.frames(0);
  for (const auto& [mesh, is_fine] : {std::pair{Dust(100, 0), true}, {Dust(100, 5000), true}, {Dust(3000, 0), false}}) {
    const SnappedMesh snapped = *Snap(mesh, grid.lattice, grid.origin, ReachOf(frames));
    EXPECT_EQ(FinenessOf(snapped, MakeScanFrames(frames)).most_tiny, is_fine);
    std::string expected;
    for (const Simd simd : SimdHere()) {
      const ForcedSimd forced(simd);
      const std::string digest = Voxelize(mesh, grid, {.separability = 0}, 2).totals.digest.ToHex();
      if (expected.empty()) expected = digest;
      EXPECT_EQ(digest, expected) << SimdInUse();
    }
  }
}

// The lowest corner lies just below a tile, but every voxel with a half-link to the mesh lies above. So the tiles begin
// above the corner.
TEST(FineMeshes, MayBeginBelowTheirFirstTileOnEachKernel) {
  TriangleMesh mesh = FineSphere();
  Vec3f low = mesh.vertices.front();
  for (const Vec3f& v : mesh.vertices) {
    for (size_t m = 0; m < 3; ++m) low[m] = std::min(low[m], v[m]);
  }
  Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  for (size_t m = 0; m < 3; ++m) grid.origin[m] = double{low[m]} - kTileSide + 0.25;
  const auto frames = grid.lattice.frames(0);
  const SnappedMesh snapped = *Snap(mesh, grid.lattice, grid.origin, ReachOf(frames));
  ASSERT_TRUE(FinenessOf(snapped, MakeScanFrames(frames)).most_tiny);
  for (const int32_t x : snapped.box.min) ASSERT_EQ(x % kTileSide, 0);
  for (const int k : {0, 2}) {
    std::string expected;
    for (const Simd simd : SimdHere()) {
      const ForcedSimd forced(simd);
      const std::string digest = Voxelize(mesh, grid, {.separability = k}, 2).totals.digest.ToHex();
      if (expected.empty()) expected = digest;  // of plain C++, which comes first
      EXPECT_EQ(digest, expected) << SimdInUse();
    }
  }
}

TEST(FineMeshes, HaveTheFactsOfAnyMesh) {
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  TriangleMesh open = FineSphere(), flat = FineSphere(), heaps = FineMesh(500);
  open.triangles.erase(open.triangles.begin() + 5000);
  for (uint32_t n = 0; n < 3000; n += 3) flat.triangles.push_back({n, n + 1, n});
  for (const TriangleMesh& mesh : {FineSphere(), open, flat, heaps}) {
    const auto frames = grid.lattice.frames(0);
    const SurfaceFacts expected = FactsOf(*Snap(mesh, grid.lattice, grid.origin, ReachOf(frames)));
    for (const Simd simd : SimdHere()) {
      const ForcedSimd forced(simd);
      for (const bool solid : {false, true}) {
        VoxelizeOptions options;
        if (solid) options.set = Solid{.force_open = true};
        const auto job = VoxelizeJob::Create(mesh, grid, options);
        ASSERT_TRUE(job.ok()) << job.status();
        EXPECT_EQ((*job)->facts().closed, expected.closed) << SimdInUse();
        EXPECT_EQ((*job)->facts().degenerate_triangles, expected.degenerate_triangles) << SimdInUse();
      }
    }
  }
  const auto facts = [&](const TriangleMesh& mesh) {
    return FactsOf(*Snap(mesh, grid.lattice, grid.origin, {1, 1, 1}));
  };
  EXPECT_TRUE(facts(flat).closed);
  EXPECT_EQ(facts(flat).degenerate_triangles, facts(FineSphere()).degenerate_triangles + 1000);
  EXPECT_FALSE(facts(open).closed);
}

TEST(FineMeshes, ComeInCanonicalOrderWithProgress) {
  const TriangleMesh mesh = FineMesh(2000);
  const Result result = Voxelize(mesh, Unscaled(Lattice::Named(NamedLattice::kCartesian)), {.separability = 2}, 1);
  ASSERT_GT(result.tiles.size(), 8U);
  Vec3i first = result.tiles.front().tile_ijk;
  for (const TileBricks& tile : result.tiles) {
    for (size_t m = 0; m < 3; ++m) first[m] = std::min(first[m], tile.tile_ijk[m]);
  }
  for (size_t n = 1; n < result.tiles.size(); ++n) {
    EXPECT_LT(Morton(result.tiles[n - 1].tile_ijk - first), Morton(result.tiles[n].tile_ijk - first));
    EXPECT_LE(result.tiles[n - 1].progress, result.tiles[n].progress);
  }
  EXPECT_GT(result.tiles.front().progress, 0);
  EXPECT_LT(result.tiles.front().progress, 0.5);
  EXPECT_LE(result.tiles.back().progress, 1);
  EXPECT_GT(result.tiles.back().progress, 0.5);
}

}  // namespace
}  // namespace latvox
