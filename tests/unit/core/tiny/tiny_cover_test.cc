// The cells that tiny triangles meet and their storage, compared with the supercover of each triangle.
#include "core/tiny/tiny_cover.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/digitize/cell_box.h"
#include "core/lattice/integer_cell.h"
#include "core/supercover/supercover.h"
#include "core/tile/tile_links.h"
#include "core/tiny/tiny.h"
#include "tests/unit/core/simd.h"
#include "tests/unit/core/triangles.h"

namespace latvox {
namespace {

constexpr int32_t kFar = 1 << 20;
constexpr IndexBox kEverywhere{{-kFar, -kFar, -kFar}, {kFar, kFar, kFar}};

using Voxels = std::set<Vec3i>;

void AddCover(const Triangle& triangle, const IndexBox& box, Voxels& voxels) {
  static const Supercover supercover(IntegerCell::Of(Lattice::Named(NamedLattice::kCartesian)).value());
  supercover.ForEachRun(triangle, box, [&](const Vec3i& first, int32_t count) {
    for (int32_t n = 0; n < count; ++n) voxels.insert(first + Vec3i{0, 0, n});
  });
}

// Returns the voxels in the cube of so many tiles a side.
Voxels Collected(const TileLinks& links, const Vec3i& tile_min, int32_t tiles) {
  const BitsLayout layout(tile_min, {}, tiles * kTileSide);
  const IndexBox block{layout.origin, layout.origin + layout.side};
  Voxels collected;
  links.ForEachBatch(block, block, layout, {}, [&](const Crossings& some) {
    for (const uint32_t voxel : some.nearer.view()) collected.insert(layout.VoxelAt(voxel));
  });
  return collected;
}

bool IsTiny(const Triangle& triangle) {
  const IndexBox cells = BoxOfCells(triangle);
  const Vec3i side = cells.max - cells.min;
  return std::max({side[0], side[1], side[2]}) <= kMostCells;
}

// Corners are multiples of `grain`. Many triangles cross borders of tiles or touch cells, and some have no area.
std::vector<Triangle> TinyTriangles(const Vec3i& tile_min, int32_t size, int32_t grain) {
  std::vector<Triangle> triangles = TrianglesAround(tile_min, size, 3001);
  std::mt19937 random(kSeed);
  for (size_t n = 0; n < triangles.size(); ++n) {
    if (n % 4 == 0) {  // at the tile's low corner
      const Vec3i by = tile_min * kLatticeUnit - triangles[n][0];
      const Vec3i off{static_cast<int32_t>(random() % 512) - 256, static_cast<int32_t>(random() % 512) - 256,
                      static_cast<int32_t>(random() % 512) - 256};
      for (Vec3i& v : triangles[n]) v = v + by + off;
    }
    if (n % 19 == 0) triangles[n][2] = triangles[n][1] = triangles[n][0];
    for (Vec3i& v : triangles[n]) {
      for (int32_t& x : v) x &= -grain;
    }
    if (n % 23 == 0) triangles[n][2] = triangles[n][1] + (triangles[n][1] - triangles[n][0]);  // a segment
  }
  for (size_t n = 0; n < triangles.size(); n += 50) {  // slivers with a corner that does not fit 16 bits
    triangles[n][1] = triangles[n][0] + Vec3i{1 << 16, 1 << 16, 3};
    triangles[n][2] = triangles[n][0] + Vec3i{40, 60, 5};
  }
  return triangles;
}

void ExpectAllCells(const Vec3i& first_tile, const Vec3i& tile_min) {
  for (const int32_t size : {8, 40, 90, 200, 300}) {
    for (const int32_t grain : {1, 16, 64, 128, 256}) {
      const std::vector<Triangle> triangles = TinyTriangles(tile_min, size, grain);
      const SnappedMesh mesh = MeshOf(triangles);
      Voxels expected;
      std::vector<uint32_t> large;
      for (uint32_t t = 0; t < triangles.size(); ++t) {
        if (IsTiny(triangles[t])) {
          AddCover(triangles[t], kEverywhere, expected);
        } else {
          large.push_back(t);
        }
      }
      ASSERT_FALSE(expected.empty());
      for (const Simd simd : SimdHere()) {
        if (simd == Simd::kScalar) continue;  // has none
        const ForcedSimd forced(simd);
        SCOPED_TRACE(absl::StrCat("size ", size, " grain ", grain, " ", std::string(SimdInUse())));
        TileLinks found(first_tile, {});
        std::vector<uint32_t> others{7};  // earlier entries stay
        {
          TinyCover cover(kEverywhere, found);
          ForEachList(mesh, TinyCrossings::Origin(found), [&](const CornerList& list) { cover.Find(list, others); });
        }
        found.Finish();
        ASSERT_EQ(others.front(), 7U);
        others.erase(others.begin());
        ASSERT_EQ(others, large);
        ASSERT_EQ(Collected(found, tile_min - Vec3i{1, 1, 1} * kTileSide, 4), expected);
      }
    }
  }
}

TEST(TinyCover, HasAllCellsThatTinyTrianglesMeetOnEachKernel) { ExpectAllCells({1, 0, 2}, {128, 64, 192}); }

// Coordinates of voxels, counted from the first tile, take 16 bits.
TEST(TinyCover, HasAllCellsFarFromTheFirstTileOnEachKernel) { ExpectAllCells({0, 0, 0}, {65280, 32704, 65280}); }

TEST(TinyCover, LeavesOutCellsOutsideOfTheBoxOnEachKernel) {
  const Vec3i tile_min{64, 0, 0};
  const IndexBox box{{70, 3, 10}, {100, 60, 33}};
  const std::vector<Triangle> triangles = TinyTriangles(tile_min, 100, 1);
  const SnappedMesh mesh = MeshOf(triangles);
  Voxels expected;
  for (const Triangle& triangle : triangles) {
    if (IsTiny(triangle)) AddCover(triangle, box, expected);
  }
  ASSERT_GT(expected.size(), 100U);
  for (const Simd simd : SimdHere()) {
    if (simd == Simd::kScalar) continue;  // has none
    const ForcedSimd forced(simd);
    SCOPED_TRACE(std::string(SimdInUse()));
    TileLinks found(Shifted(tile_min, kTileBits) - Vec3i{1, 1, 1}, {});
    std::vector<uint32_t> others;
    {
      TinyCover cover(box, found);
      ForEachList(mesh, TinyCrossings::Origin(found), [&](const CornerList& list) { cover.Find(list, others); });
    }
    found.Finish();
    EXPECT_EQ(Collected(found, tile_min, 1), expected);
  }
}

}  // namespace
}  // namespace latvox
