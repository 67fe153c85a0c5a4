// Closedness and degenerate triangles, compared with a table of all edges.
#include "core/triangles/surface_facts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "tests/unit/core/simd.h"

namespace latvox {
namespace {

// The parts of a mesh.
struct Surface {
  PaddedVector<Vec3i> vertices_lat;
  std::vector<std::array<uint32_t, 3>> triangles;
  operator SnappedMesh() const { return {{}, vertices_lat, triangles, {}}; }
};

// Facts from a table of all edges, and from exact areas.
SurfaceFacts CountedFacts(const SnappedMesh& mesh) {
  SurfaceFacts facts;
  std::map<std::pair<Vec3i, Vec3i>, int> edges;
  for (const auto& [i, j, k] : mesh.triangles) {
    const std::array<Vec3i, 3> v{mesh.vertices_lat[i], mesh.vertices_lat[j], mesh.vertices_lat[k]};
    for (size_t n = 0; n < 3; ++n) {
      const Vec3i &a = v[n], &b = v[(n + 1) % 3];
      if (a != b) ++edges[std::minmax(a, b)];
    }
    using Wide = std::array<__int128, 3>;
    const Vec3i a = v[1] - v[0], b = v[2] - v[0];
    facts.degenerate_triangles += Cross(Wide{a[0], a[1], a[2]}, Wide{b[0], b[1], b[2]}) == Wide{};
  }
  facts.closed = std::all_of(edges.begin(), edges.end(), [](const auto& edge) { return edge.second % 2 == 0; });
  return facts;
}

TEST(SurfaceFacts, AgreeWithATableOfAllEdges) {
  constexpr unsigned kSeed = 19;
  std::mt19937 random(kSeed);
  int closed = 0, open = 0;
  for (int round = 0; round < 400; ++round) {
    // A few positions, each at several vertices: many triangles are degenerate, edges coincide.
    const auto positions = static_cast<uint32_t>(4 + random() % 12);
    const int32_t spread = round % 2 == 0 ? 3 : 1 << 25;
    Surface mesh;
    for (uint32_t n = 0; n < 3 * positions; ++n) {
      const bool again = n >= positions;
      mesh.vertices_lat.push_back(again ? mesh.vertices_lat[n - positions]
                                        : Vec3i{static_cast<int32_t>(random() % static_cast<uint32_t>(spread)),
                                                static_cast<int32_t>(random() % static_cast<uint32_t>(spread)),
                                                static_cast<int32_t>(random() % static_cast<uint32_t>(spread))});
    }
    const auto vertex = [&] { return static_cast<uint32_t>(random() % mesh.vertices_lat.size()); };
    const auto other = [&](uint32_t v) { return static_cast<uint32_t>((v + positions) % mesh.vertices_lat.size()); };
    for (int n = 0; n < 6; ++n) {
      const std::array<uint32_t, 4> v{vertex(), vertex(), vertex(), vertex()};
      switch (random() % 4) {
        case 0:  // a tetrahedron, even of four points that coincide or lie in a line
          mesh.triangles.insert(mesh.triangles.end(), {{v[0], v[1], v[2]}, {v[0], v[3], other(v[1])}});
          mesh.triangles.insert(mesh.triangles.end(), {{other(v[2]), v[3], v[0]}, {v[1], v[2], other(v[3])}});
          break;
        case 1:  // a triangle twice
          mesh.triangles.insert(mesh.triangles.end(), {{v[0], v[1], v[2]}, {other(v[2]), v[0], other(v[1])}});
          break;
        case 2:  // an edge and a point
          mesh.triangles.insert(mesh.triangles.end(), {{v[0], other(v[0]), v[1]}, {v[2], v[3], other(v[3])}});
          mesh.triangles.push_back({v[0], v[0], other(v[0])});
          break;
        default:
          if (random() % 3 == 0) mesh.triangles.push_back({v[0], v[1], v[2]});
      }
    }
    if (mesh.triangles.empty()) continue;
    const SurfaceFacts expected = CountedFacts(mesh);
    (expected.closed ? closed : open)++;
    WithEachSimd([&] {
      const SurfaceFacts facts = FactsOf(mesh);
      ASSERT_EQ(facts.closed, expected.closed) << kSeed << " round " << round;
      ASSERT_EQ(facts.degenerate_triangles, expected.degenerate_triangles) << kSeed << " round " << round;
    });
  }
  EXPECT_GT(closed, 50);
  EXPECT_GT(open, 50);
}

TEST(SurfaceFacts, OneTriangleMoreOrLessOpensALargeClosedMesh) {
  Surface mesh;  // a torus of quads
  constexpr uint32_t kSide = 150;
  for (uint32_t n = 0; n < kSide * kSide; ++n) {
    mesh.vertices_lat.push_back({static_cast<int32_t>(n / kSide * 97), static_cast<int32_t>(n % kSide * 31),
                                 static_cast<int32_t>(n * n % 1009)});
  }
  const auto at = [](uint32_t i, uint32_t j) { return i % kSide * kSide + j % kSide; };
  for (uint32_t n = 0; n < kSide * kSide; ++n) {
    const uint32_t i = n / kSide, j = n % kSide;
    mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
    mesh.triangles.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
  }
  WithEachSimd([&] {
    EXPECT_TRUE(FactsOf(mesh).closed);
    for (size_t n : {size_t{0}, size_t{12345}, mesh.triangles.size() - 1}) {
      Surface open = mesh;
      open.triangles.erase(open.triangles.begin() + static_cast<ptrdiff_t>(n));
      EXPECT_FALSE(FactsOf(open).closed);
      open.triangles.push_back(mesh.triangles[n]);
      EXPECT_TRUE(FactsOf(open).closed);
      open.triangles.push_back(mesh.triangles[n]);
      EXPECT_FALSE(FactsOf(open).closed);
    }
  });
}

TEST(SurfaceFacts, CountEveryTriangleOfEveryPartOfAMesh) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int32_t> any(0, 7);
  Surface mesh;
  for (int n = 0; n < 100; ++n) mesh.vertices_lat.push_back({any(random), any(random), any(random)});
  std::uniform_int_distribution<uint32_t> vertex(0, 99);
  for (const size_t size : {1, 2, 3, 4, 5, 15, 16, 17, 1023, 1024, 1025, 2050, 4096, 4099}) {
    while (mesh.triangles.size() < size) mesh.triangles.push_back({vertex(random), vertex(random), vertex(random)});
    mesh.triangles.back() = {99, 99, 99};
    const SurfaceFacts expected = CountedFacts(mesh);
    Surface twice = mesh;  // which closes it
    twice.triangles.insert(twice.triangles.end(), mesh.triangles.begin(), mesh.triangles.end());
    WithEachSimd([&] {
      EXPECT_EQ(FactsOf(mesh).degenerate_triangles, expected.degenerate_triangles) << size;
      EXPECT_EQ(FactsOf(mesh).closed, expected.closed) << size;
      EXPECT_EQ(FactsOf(twice).degenerate_triangles, 2 * expected.degenerate_triangles) << size;
      EXPECT_TRUE(FactsOf(twice).closed) << size;
    });
  }
}

TEST(SurfaceFacts, AnAreaThatVanishesModuloTwoToThe32IsAnArea) {
  Surface mesh;
  mesh.vertices_lat = {{0, 0, 0}, {1 << 16, 0, 0}, {0, 1 << 16, 0}, {1 << 17, 0, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}};
  WithEachSimd([&] { EXPECT_EQ(FactsOf(mesh).degenerate_triangles, 1U); });
  for (int n = 0; n < 7; ++n) mesh.triangles.push_back(mesh.triangles[n % 3 == 0 ? 1 : 0]);
  WithEachSimd([&] { EXPECT_EQ(FactsOf(mesh).degenerate_triangles, 4U); });
}

TEST(SurfaceFacts, FlatTrianglesAreCountedUpToTheExtentThatLanesHoldAndBeyond) {
  for (const int32_t extent : {1, (1 << 15) - 1, 1 << 15, (1 << 15) + 1}) {
    for (const int32_t other : {2, extent}) {  // small triangles beside large ones, and large ones alone
      Surface mesh;
      mesh.vertices_lat = {{0, 0, 0}, {extent, 0, 0}, {0, extent, 0}, {2 * extent, 0, 0},
                           {0, 0, 9}, {other, 0, 9},  {0, other, 9},  {0, 2 * other, 9}};
      for (int n = 0; n < 3; ++n)
        mesh.triangles.insert(mesh.triangles.end(), {{0, 1, 2}, {4, 6, 7}, {4, 5, 6}, {0, 3, 1}});
      const SurfaceFacts expected = CountedFacts(mesh);
      EXPECT_EQ(expected.degenerate_triangles, 6U);
      WithEachSimd([&] {
        EXPECT_EQ(FactsOf(mesh).degenerate_triangles, 6U) << extent << " beside " << other;
        EXPECT_EQ(FactsOf(mesh).closed, expected.closed) << extent << " beside " << other;
      });
    }
  }
}

TEST(SurfaceFacts, ClosedIsByPositionNotByIndex) {
  // A tetrahedron whose triangles share no vertex.
  const Vec3f p[] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}};
  TriangleMesh mesh;
  for (const std::array<int, 3>& t : {std::array{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}) {
    const auto n = static_cast<uint32_t>(mesh.vertices.size());
    for (int v : t) mesh.vertices.push_back(p[v]);
    mesh.triangles.push_back({n, n + 1, n + 2});
  }
  const auto facts = [](TriangleMesh m) {
    return FactsOf(*Snap(std::move(m), Lattice::Named(NamedLattice::kCartesian), {0, 0, 0}, {1, 1, 1}));
  };
  EXPECT_TRUE(facts(mesh).closed);
  EXPECT_EQ(facts(mesh).degenerate_triangles, 0U);
  TriangleMesh open = mesh;
  open.triangles.pop_back();
  EXPECT_FALSE(facts(open).closed);
  TriangleMesh degenerate = mesh;  // one more triangle, an edge; the mesh stays closed
  degenerate.triangles.push_back({0, 1, 1});
  EXPECT_TRUE(facts(degenerate).closed);
  EXPECT_EQ(facts(degenerate).degenerate_triangles, 1U);
}

}  // namespace
}  // namespace latvox
