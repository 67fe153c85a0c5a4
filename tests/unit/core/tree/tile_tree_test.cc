// The triangles that concern each tile, compared with a test of every triangle and tile.
#include "core/tree/tile_tree.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <random>
#include <set>
#include <vector>

#include "core/base/stop_signal.h"
#include "tests/unit/core/simd.h"
#include "tests/unit/dose.h"

namespace latvox {
namespace {

constexpr int32_t kTileUnits = kTileSide * kLatticeUnit;
using Corners = std::array<Vec3i, 3>;

struct Margins {
  Vec3i near, far;
};
constexpr std::array<Margins, 4> kMargins{
    {{{1, 1, 1}, {1, 1, 1}}, {{3, 3, 3}, {9, 9, 9}}, {{6, 3, 6}, {18, 9, 18}}, {{24, 12, 3}, {72, 36, 9}}}};

// A mesh without shared vertices, and its box.
SnappedMesh MeshOf(const std::vector<Corners>& triangles) {
  SnappedMesh mesh;
  PaddedVector<Vec3i> vertices_lat;
  std::vector<std::array<uint32_t, 3>> indices;
  Vec3i low = triangles.front().front(), high = low;
  for (const Corners& corners : triangles) {
    const auto n = static_cast<uint32_t>(vertices_lat.size());
    indices.push_back({n, n + 1, n + 2});
    for (const Vec3i& v : corners) {
      vertices_lat.push_back(v);
      for (size_t m = 0; m < 3; ++m) {
        low[m] = std::min(low[m], v[m]);
        high[m] = std::max(high[m], v[m]);
      }
    }
  }
  mesh.vertices_lat = std::move(vertices_lat);
  mesh.triangles = std::move(indices);
  for (size_t m = 0; m < 3; ++m) mesh.box.min[m] = (low[m] >> kSubvoxelBits) - 1;
  for (size_t m = 0; m < 3; ++m) mesh.box.max[m] = (high[m] >> kSubvoxelBits) + 2;
  return mesh;
}

// `count` triangles with corners up to `side` lattice units from a point, in a cube of `extent` voxels from `low` on.
std::vector<Corners> RandomTriangles(std::mt19937& random, size_t count, int32_t side, int32_t extent,
                                     int32_t low = 0) {
  const auto up_to = [&](int32_t n) { return static_cast<int32_t>(random() % static_cast<uint32_t>(n)); };
  std::vector<Corners> triangles(count);
  for (Corners& corners : triangles) {
    Vec3i at;
    for (int32_t& x : at) x = low * kLatticeUnit + up_to(extent * kLatticeUnit - side);
    for (Vec3i& v : corners) v = at + Vec3i{up_to(side), up_to(side), up_to(side)};
    // Corners on borders of tiles.
    if (random() % 8 == 0) corners[0][random() % 3] &= ~(kTileUnits - 1);
  }
  return triangles;
}

struct Box {
  Vec3i min, max;  // lattice units, closed
};

Box BoxAround(const Vec3i& tile_ijk, const Vec3i& margin, int32_t more = 0) {
  Box box;
  for (size_t m = 0; m < 3; ++m) {
    box.min[m] = tile_ijk[m] * kTileUnits - margin[m] * kLatticeUnit - more;
    box.max[m] = (tile_ijk[m] + 1) * kTileUnits + margin[m] * kLatticeUnit + more;
  }
  return box;
}

bool BoundsMeet(const Corners& v, const Box& box) {
  for (size_t m = 0; m < 3; ++m) {
    if (std::min({v[0][m], v[1][m], v[2][m]}) > box.max[m]) return false;
    if (std::max({v[0][m], v[1][m], v[2][m]}) < box.min[m]) return false;
  }
  return true;
}

// Exact: a triangle and a box are apart iff one of 13 axes separates them.
bool Meet(const Corners& v, const Box& box) {
  using Wide = std::array<__int128, 3>;
  const auto wide = [](const Vec3i& a) { return Wide{a[0], a[1], a[2]}; };
  std::vector<Wide> axes{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, Cross(wide(v[1] - v[0]), wide(v[2] - v[0]))};
  for (size_t n = 0; n < 3; ++n) {
    for (size_t m = 0; m < 3; ++m) axes.push_back(Cross(axes[m], wide(v[(n + 1) % 3] - v[n])));
  }
  for (const Wide& axis : axes) {
    __int128 low = 0, high = 0;
    for (size_t m = 0; m < 3; ++m) {
      low += axis[m] * (axis[m] > 0 ? box.min[m] : box.max[m]);
      high += axis[m] * (axis[m] > 0 ? box.max[m] : box.min[m]);
    }
    const std::array<__int128, 3> p{Dot(axis, v[0]), Dot(axis, v[1]), Dot(axis, v[2])};
    if (*std::min_element(p.begin(), p.end()) > high || *std::max_element(p.begin(), p.end()) < low) return false;
  }
  return true;
}

bool IsLong(const Corners& v) {
  for (size_t m = 0; m < 3; ++m) {
    if (std::max({v[0][m], v[1][m], v[2][m]}) - std::min({v[0][m], v[1][m], v[2][m]}) >= kTileUnits) return true;
  }
  return false;
}

// Returns all tiles, in their order of delivery.
std::vector<TileNode> Tiles(const TileTree& tree) {
  std::vector<TileNode> tiles, todo = tree.Top();
  std::reverse(todo.begin(), todo.end());
  while (!todo.empty()) {
    TileNode node = std::move(todo.back());
    todo.pop_back();
    if (node.level == 0) {
      tiles.push_back(std::move(node));
      continue;
    }
    std::vector<TileNode> children = tree.Children(node);
    std::move(children.rbegin(), children.rend(), std::back_inserter(todo));
  }
  return tiles;
}

std::vector<TileNode> Tiles(const SnappedMesh& mesh, const Margins& margins, const IndexBox& region) {
  return Tiles(TileTree(mesh, 0, margins.near, margins.far, region, StopSignal()));
}

uint64_t Morton(const Vec3i& tile_ijk, const Vec3i& low) {
  uint64_t code = 0;
  for (int bit = 11; bit >= 0; --bit) {
    for (size_t m = 0; m < 3; ++m) code = code << 1 | (static_cast<uint64_t>(tile_ijk[m] - low[m]) >> bit & 1);
  }
  return code;
}

bool Wanted(const Vec3i& tile_ijk, const IndexBox& region) {
  for (size_t m = 0; m < 3; ++m) {
    if ((tile_ijk[m] + 1) * kTileSide <= region.min[m] || region.max[m] <= tile_ijk[m] * kTileSide) return false;
  }
  return true;
}

void ExpectSame(const std::vector<TileNode>& a, const std::vector<TileNode>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t n = 0; n < a.size(); ++n) {
    ASSERT_EQ(a[n].tile_ijk, b[n].tile_ijk);
    ASSERT_EQ(a[n].triangles, b[n].triangles);
    ASSERT_EQ(a[n].fringe, b[n].fringe);
    ASSERT_EQ(a[n].progress, b[n].progress);
    ASSERT_EQ(a[n].share, b[n].share);
  }
}

// Tests every triangle against every tile.
void ExpectExact(const std::vector<Corners>& triangles, const Margins& margins, const IndexBox& region,
                 const SnappedMesh& mesh, const std::vector<TileNode>& tiles) {
  Vec3i low, high;
  for (size_t m = 0; m < 3; ++m) {
    low[m] = mesh.box.min[m] >> kTileBits;
    high[m] = (mesh.box.max[m] - 1) >> kTileBits;
  }
  std::set<Vec3i> found;
  double progress = 0;
  for (size_t n = 0; n < tiles.size(); ++n) {
    const TileNode& tile = tiles[n];
    ASSERT_TRUE(Wanted(tile.tile_ijk, region));
    ASSERT_TRUE(n == 0 || Morton(tiles[n - 1].tile_ijk, low) < Morton(tile.tile_ijk, low));
    ASSERT_TRUE(std::is_sorted(tile.triangles.begin(), tile.triangles.end(), std::less_equal<>()));
    ASSERT_TRUE(std::is_sorted(tile.fringe.begin(), tile.fringe.end(), std::less_equal<>()));
    ASSERT_GE(tile.progress, progress - 1e-9);
    progress = tile.progress + tile.share;
    found.insert(tile.tile_ijk);
    const Box near = BoxAround(tile.tile_ijk, margins.near), far = BoxAround(tile.tile_ijk, margins.far);
    const Box nearly_near = BoxAround(tile.tile_ijk, margins.near, 1);
    const Box nearly_far = BoxAround(tile.tile_ijk, margins.far, 1);
    for (uint32_t t = 0; t < triangles.size(); ++t) {
      const bool is_near = std::binary_search(tile.triangles.begin(), tile.triangles.end(), t);
      const bool is_fringe = std::binary_search(tile.fringe.begin(), tile.fringe.end(), t);
      ASSERT_FALSE(is_near && is_fringe);
      if (!BoundsMeet(triangles[t], far)) {
        ASSERT_FALSE(is_near || is_fringe) << t;
        continue;
      }
      ASSERT_TRUE(is_near || !Meet(triangles[t], near)) << t;
      ASSERT_TRUE(is_near || is_fringe || !Meet(triangles[t], far)) << t;
      ASSERT_TRUE(!is_near || BoundsMeet(triangles[t], near)) << t;
      if (!IsLong(triangles[t])) continue;
      ASSERT_TRUE(!is_near || Meet(triangles[t], nearly_near)) << t;
      ASSERT_TRUE(!is_fringe || Meet(triangles[t], nearly_far)) << t;
    }
  }
  EXPECT_LE(progress, 1 + 1e-9);
  for (int32_t i = low[0]; i <= high[0]; ++i) {
    for (int32_t j = low[1]; j <= high[1]; ++j) {
      for (int32_t k = low[2]; k <= high[2]; ++k) {
        if (!Wanted({i, j, k}, region) || found.contains({i, j, k})) continue;
        const Box near = BoxAround({i, j, k}, margins.near);
        for (const Corners& corners : triangles) {
          ASSERT_FALSE(BoundsMeet(corners, near) && Meet(corners, near)) << i << " " << j << " " << k;
        }
      }
    }
  }
}

TEST(TileTree, ListsTheTrianglesWithinBothMarginsOfEachTile) {
  constexpr unsigned kSeed = 23;
  std::mt19937 random(kSeed);
  for (const Margins& margins : kMargins) {
    for (const auto& [count, side, extent] : {std::array{1, 40, 3},
                                              {300, 2000, 60},
                                              {300, 3000, 500},
                                              {3000, 500, 700},
                                              {60, 30000, 400},
                                              {40, 250000, 1100},
                                              {1000, 40000, 600},
                                              {12, 500000, 2100}}) {
      SCOPED_TRACE(testing::Message() << "seed " << kSeed << " triangles " << count << " side " << side);
      const auto triangles = RandomTriangles(random, static_cast<size_t>(count), std::min(side, extent * 200), extent);
      const SnappedMesh mesh = MeshOf(triangles);
      ExpectExact(triangles, margins, mesh.box, mesh, Tiles(mesh, margins, mesh.box));
    }
  }
}

TEST(TileTree, LeavesOutTilesOutsideOfARegion) {
  constexpr unsigned kSeed = 29;
  std::mt19937 random(kSeed);
  const auto triangles = RandomTriangles(random, 2000, 20000, 900);
  const SnappedMesh mesh = MeshOf(triangles);
  for (const IndexBox& region : {IndexBox{{100, 300, 0}, {101, 301, 1}}, IndexBox{{64, 128, 192}, {128, 256, 600}},
                                 IndexBox{{0, 0, 0}, {900, 64, 65}}, IndexBox{{100, 100, 100}, {100, 200, 200}}}) {
    const auto tiles = Tiles(mesh, kMargins[1], region);
    EXPECT_EQ(tiles.empty(), region.min[0] == region.max[0]);
    if (!tiles.empty()) ExpectExact(triangles, kMargins[1], region, mesh, tiles);
  }
  EXPECT_TRUE(Tiles(mesh, kMargins[1], {{5000, 0, 0}, {5001, 900, 900}}).empty());
}

// There are enough triangles that chunks are sorted in parallel, in the whole mesh and in a part with a fringe.
TEST(TileTree, LargeNodesAreTheSameForAnyNumberOfThreads) {
  constexpr unsigned kSeed = 31;
  std::mt19937 random(kSeed);
  auto triangles = RandomTriangles(random, 70000, 900, 110, 900);
  const auto others = RandomTriangles(random, 3000, 4000, 2100);
  triangles.insert(triangles.begin() + 5000, others.begin(), others.end());
  const SnappedMesh mesh = MeshOf(triangles);
  const oneapi::tbb::global_control threads(oneapi::tbb::global_control::max_allowed_parallelism, 4);
  std::array<std::vector<TileNode>, 2> tiles;
  oneapi::tbb::task_arena(1).execute([&] { tiles[0] = Tiles(mesh, kMargins[1], mesh.box); });
  oneapi::tbb::task_arena(4).execute([&] { tiles[1] = Tiles(mesh, kMargins[1], mesh.box); });
  ExpectSame(tiles[0], tiles[1]);
  const IndexBox region{{850, 850, 850}, {1100, 1100, 1100}};
  ExpectExact(triangles, kMargins[1], region, mesh, Tiles(mesh, kMargins[1], region));
}

TEST(TileTree, EveryKernelGivesTheSame) {
  constexpr unsigned kSeed = 37;
  std::mt19937 random(kSeed);
  for (const int32_t side : {700, 9000, 90000}) {
    for (const Margins& margins : kMargins) {
      const SnappedMesh mesh = MeshOf(RandomTriangles(random, Dose(4000, 800), side, 1500));
      std::optional<std::vector<TileNode>> expected;  // by plain C++, which comes first
      for (const Simd simd : SimdHere()) {
        const ForcedSimd forced(simd);
        SCOPED_TRACE(SimdInUse());
        const auto tiles = Tiles(mesh, margins, mesh.box);
        if (!expected) expected = tiles;
        ExpectSame(tiles, *expected);
      }
    }
  }
}

// Two triangles as large as the lattice allows meet more than a million of eight billion tiles.
TEST(TileTree, HoldsOnePathOfALargeLattice) {
  constexpr int32_t kMost = kMaxExtent * kLatticeUnit - 1;
  const SnappedMesh mesh =
      MeshOf({{{{0, 0, 0}, {kMost, 5, 7}, {9, kMost, kMost}}}, {{{0, 0, 9}, {0, kMost, 0}, {kMost, 9, 0}}}});
  const TileTree tree(mesh, 0, {3, 3, 3}, {9, 9, 9}, mesh.box, StopSignal());
  std::vector<TileNode> todo = tree.Top();
  std::reverse(todo.begin(), todo.end());
  size_t most = 0, nodes = 0;
  for (; !todo.empty() && nodes < 20000; ++nodes) {
    most = std::max(most, todo.size());
    const TileNode node = std::move(todo.back());
    todo.pop_back();
    if (node.level == 0) continue;
    std::vector<TileNode> children = tree.Children(node);
    std::move(children.rbegin(), children.rend(), std::back_inserter(todo));
  }
  EXPECT_EQ(nodes, 20000U);
  EXPECT_LT(most, 500U);
}

TEST(TileTree, GivesNothingOnceCancelled) {
  std::mt19937 random(41);
  const SnappedMesh mesh = MeshOf(RandomTriangles(random, 100, 900, 500));
  StopSource source;
  const TileTree tree(mesh, 0, {3, 3, 3}, {9, 9, 9}, mesh.box, source.Signal());
  EXPECT_FALSE(tree.Top().empty());
  source.Stop();
  EXPECT_TRUE(tree.Top().empty());
}

}  // namespace
}  // namespace latvox
