// Meshes and their one rounding.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/snap/snap.h"

namespace latvox {
namespace {

const Lattice& Cartesian() {
  static const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  return lattice;
}

TriangleMesh OneTriangle(const Vec3f& a, const Vec3f& b, const Vec3f& c) { return {{a, b, c}, {{0, 1, 2}}}; }

Vec3i GlobalUnits(const SnappedMesh& mesh, size_t vertex) {
  return mesh.vertices_lat[vertex] + mesh.base_ijk * kLatticeUnit;
}

TEST(Mesh, ValidationNamesTheElement) {
  TriangleMesh mesh = OneTriangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  EXPECT_TRUE(Validate(mesh).ok());
  mesh.vertices.push_back({0, NAN, 0});
  EXPECT_EQ(Validate(mesh).message(), "mesh: vertex 3 is not finite");
  mesh.vertices.pop_back();
  mesh.triangles.push_back({0, 1, 3});
  EXPECT_EQ(Validate(mesh).message(), "mesh: triangle 1 uses vertex 3 of 3");
  mesh.triangles.clear();
  EXPECT_EQ(Validate(mesh).message(), "mesh: it has no triangles");
}

TEST(Mesh, BoundsIgnoreVerticesThatNoTriangleUses) {
  TriangleMesh mesh = OneTriangle({-1, 2, 3}, {4, 5, 6}, {0, 0, 0});
  mesh.vertices.push_back({1000, 1000, 1000});
  const Bounds bounds = BoundsOf(mesh);
  EXPECT_EQ(bounds.min, (Vec3d{-1, 0, 0}));
  EXPECT_EQ(bounds.max, (Vec3d{4, 5, 6}));
  EXPECT_EQ(bounds.LongestSide(), 6);
}

TEST(Snap, RoundsHalfToEvenInUnitsOfAVoxels256thPart) {
  const float half = 0.5F / 256;
  const auto snapped =
      Snap(OneTriangle({half, 3 * half, -half}, {5, -3 * half, 2}, {1, 1, 0.3F}), Cartesian(), {0, 0, 0}, {1, 1, 1});
  ASSERT_TRUE(snapped.ok());
  EXPECT_EQ(GlobalUnits(*snapped, 0), (Vec3i{0, 2, 0}));
  EXPECT_EQ(GlobalUnits(*snapped, 1), (Vec3i{5 * 256, -2, 512}));
  EXPECT_EQ(GlobalUnits(*snapped, 2), (Vec3i{256, 256, 77}));
}

TEST(Snap, MovesNoVertexByMoreThanTheStatedBound) {
  constexpr unsigned kSeed = 11;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> coordinate(-40, 40);
  TriangleMesh mesh;
  for (uint32_t n = 0; n < 3000; ++n) {
    mesh.vertices.push_back({coordinate(random), coordinate(random), coordinate(random)});
    if (n % 3 == 2) mesh.triangles.push_back({n - 2, n - 1, n});
  }
  for (NamedLattice name :
       {NamedLattice::kCartesian, NamedLattice::kBcc, NamedLattice::kFcc, NamedLattice::kHexagonal}) {
    const Lattice lattice = *Lattice::Named(name).Scaled(0.0173);
    const Vec3d origin{0.5, -7, 11};
    const auto snapped = Snap(mesh, lattice, origin, {1, 1, 1});
    ASSERT_TRUE(snapped.ok()) << snapped.status();
    for (size_t n = 0; n < mesh.vertices.size(); ++n) {
      const Vec3f& p = mesh.vertices[n];
      const Vec3d exact = Apply(lattice.inverse(), Vec3d{p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]});
      for (size_t m = 0; m < 3; ++m) {
        EXPECT_LE(std::abs(GlobalUnits(*snapped, n)[m] / 256.0 - exact[m]), kSnapErrorMax * (1 + 1e-6)) << kSeed;
      }
    }
  }
}

TEST(Snap, BaseIsTileAlignedAndVerticesAreNotNegative) {
  const auto snapped =
      Snap(OneTriangle({-130, -64, 0}, {5, -0.001F, 63}, {64, 65, 1e-9F}), Cartesian(), {0, 0, 0}, {1, 1, 1});
  ASSERT_TRUE(snapped.ok());
  EXPECT_EQ(snapped->base_ijk, (Vec3i{-192, -128, -64}));
  for (const Vec3i& v : snapped->vertices_lat) {
    for (int32_t x : v) EXPECT_GE(x, 0);
  }
}

TEST(Snap, AcceptsTheLargestExtentAndRefusesOneMore) {
  const auto at = [](float size) {
    return Snap(OneTriangle({0, 0, 0}, {1, size, 0}, {0, 1, 1}), Cartesian(), {0, 0, 0}, {1, 1, 1});
  };
  EXPECT_TRUE(at(kMaxExtent - 1).ok());
  const auto refused = at(kMaxExtent);
  EXPECT_EQ(refused.status().message(),
            "voxel_size: the mesh extends over 131073 voxels on lattice axis j, the limit is 131072");
}

TEST(Snap, RefusesPositionsThatOverflow) {
  const auto snapped = Snap(OneTriangle({0, 0, 0}, {1, 0, 0}, {0, 1, 1}), Cartesian(), {0, 0, -1e10}, {1, 1, 1});
  EXPECT_EQ(snapped.status().message(),
            "origin: it puts the mesh at lattice coordinate 1e+10 on axis k, the limit is 536870912");
}

TEST(Snap, FarOriginGivesTheSameMeshAtShiftedCoordinates) {
  const TriangleMesh mesh = OneTriangle({0.25F, 0.5F, 3}, {9, 2.125F, 0}, {0, 7, 1});
  const auto near = Snap(mesh, Cartesian(), {0, 0, 0}, {1, 1, 1});
  const auto far = Snap(mesh, Cartesian(), {-64e6, 64e6, 0}, {1, 1, 1});
  ASSERT_TRUE(near.ok() && far.ok());
  EXPECT_EQ(near->vertices_lat, far->vertices_lat);
  EXPECT_EQ(far->base_ijk, near->base_ijk + (Vec3i{64000000, -64000000, 0}));
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
  const auto facts = [](TriangleMesh m) { return FactsOf(*Snap(std::move(m), Cartesian(), {0, 0, 0}, {1, 1, 1})); };
  EXPECT_TRUE(facts(mesh).closed);
  EXPECT_EQ(facts(mesh).degenerate_triangles, 0U);
  TriangleMesh open = mesh;
  open.triangles.pop_back();
  EXPECT_FALSE(facts(open).closed);
  TriangleMesh degenerate = mesh;  // collapses to an edge, which takes nothing from being closed
  degenerate.triangles.push_back({0, 1, 1});
  EXPECT_TRUE(facts(degenerate).closed);
  EXPECT_EQ(facts(degenerate).degenerate_triangles, 1U);
}

}  // namespace
}  // namespace latvox
