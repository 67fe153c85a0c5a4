// Where cells are not boxes, both ways to find a supercover give the voxels of Supercover, on each kernel.
#include "core/supercover/near_cells.h"

#include <gtest/gtest.h>

#include <optional>
#include <random>
#include <set>

#include "core/scan/candidates.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/simd.h"
#include "tests/unit/core/sphere.h"
#include "tests/unit/core/supercover/row_by_row.h"
#include "tests/unit/core/triangles.h"

namespace latvox {
namespace {

using oracle::Int3;

// Bases of integers, whose determinants are powers of two, so that world coordinates are exact: BCC, FCC, cubes that
// lie askew to the lattice axes, and a lattice without symmetries. More skew bases are
// refused or go row by row.
std::vector<Lattice> LatticesOfSmallCells() {
  std::vector<Lattice> lattices;
  for (const Mat3d& basis : {Mat3d{{{2, 0, 0}, {0, 2, 0}, {1, 1, 1}}}, Mat3d{{{1, 1, 0}, {1, 0, 1}, {0, 1, 1}}},
                             Mat3d{{{1, 0, 0}, {1, 1, 0}, {0, 0, 1}}}, Mat3d{{{2, 0, 0}, {1, 2, 0}, {0, 1, 2}}}}) {
    lattices.push_back(Lattice::FromBasis(basis).value());
  }
  return lattices;
}

// From triangles within a cell to some that are too large, in general position and on the corners, edges and facets of
// cells.
TEST(NearCells, BothWaysGiveTheVoxelsOfEachTriangleRowByRow) {
  std::mt19937 random(21);
  for (const Lattice& lattice : LatticesOfSmallCells()) {
    const Supercover supercover(IntegerCell::Of(lattice).value());
    for (const auto& [extent, count] : std::vector<std::pair<int64_t, size_t>>{
             {100, 200}, {400, 200}, {1000, 100}, {3000, 40}, {9000, 8}, {15000, 6}, {40000, 2}}) {
      for (const int64_t grain : {1, 16, 64, 128, 256}) {
        if (grain * 2 > extent) continue;
        const oracle::Mesh mesh = RandomTriangles(grain, extent, count, random);
        const std::set<Int3> expected = RowByRow(mesh, lattice);
        WithEachSimd([&, extent = extent] {
          const Result result = Voxelize(ToWorld(mesh, lattice), Unscaled(lattice), {.set = SupercoverSurface{}});
          ASSERT_EQ(VoxelsOf(result), expected) << "extent " << extent << " grain " << grain;
        });
      }
    }
  }
}

// One triangle at a time, so that no other covers what it misses.
TEST(NearCells, EachTriangleAloneIsCovered) {
  std::mt19937 random(22);
  for (const Lattice& lattice : LatticesOfSmallCells()) {
    for (const int64_t extent : {600, 2500, 6000, 13000}) {
      for (int n = 0; n < 40; ++n) {
        const oracle::Mesh mesh = RandomTriangles(n % 4 == 0 ? 64 : 1, extent, 1, random);
        const Result result = Voxelize(ToWorld(mesh, lattice), Unscaled(lattice), {.set = SupercoverSurface{}}, 1);
        ASSERT_EQ(VoxelsOf(result), RowByRow(mesh, lattice)) << "extent " << extent << " triangle " << n;
      }
    }
  }
}

// All voxels that the scan decides by itself, second ones included, are in the supercover.
TEST(NearCells, TheScanDecidesOnlyForVoxelsOfTheSupercover) {
  std::mt19937 random(23);
  constexpr int32_t kSide = 128, kMargin = 8;
  const IndexBox box{{0, 0, 0}, {kSide, kSide, kSide}};
  const BitsLayout layout({0, 0, 0}, {kMargin, kMargin, kMargin}, kSide);
  for (const Lattice& lattice : LatticesOfSmallCells()) {
    const Supercover supercover(IntegerCell::Of(lattice).value());
    const NearCells& cells = *supercover.near_cells();
    for (const int64_t extent : {1000, 2900}) {
      const oracle::Mesh mesh = RandomTriangles(1, extent, 100, random);
      const std::set<Int3> expected = RowByRow(mesh, lattice);
      std::vector<Triangle> triangles;
      for (const oracle::Triangle& triangle : mesh) triangles.push_back(FromOracle(triangle));
      const SearchLimits limits{box, layout, StopSignal(), SIZE_MAX};
      WithEachSimd([&] {
        if (SimdIsScalar()) return;  // it scans none
        Candidates found;
        std::vector<uint32_t> left;
        FindCoverCandidates(MeshOf(triangles), Iota(triangles.size()),
                            {cells.frames(), cells.segments(), cells.most_extent()}, limits, found, left);
        EXPECT_TRUE(left.empty());
        for (const uint32_t number : found.nearer.view()) {
          const Vec3i v = layout.VoxelAt(number & kNumberMask);
          ASSERT_TRUE(expected.contains({v[0], v[1], v[2]})) << v[0] << " " << v[1] << " " << v[2];
        }
      });
    }
  }
}

// The hexagonal lattice has no basis of integers. Plain C++ goes row by row.
TEST(NearCells, KernelsAgreeOnSpheresOfAllNamedLattices) {
  for (const NamedLattice name : {NamedLattice::kBcc, NamedLattice::kFcc, NamedLattice::kHexagonal}) {
    for (const auto& [rings, radius] : std::vector<std::pair<int, float>>{{40, 6.3F}, {24, 30.7F}, {8, 50.2F}}) {
      const TriangleMesh sphere = Sphere(rings, radius);
      std::optional<Digest> first;
      WithEachSimd([&, radius = radius] {
        const Result result = Voxelize(sphere, Unscaled(Lattice::Named(name)), {.set = SupercoverSurface{}});
        EXPECT_GT(result.totals.voxels, 200U);
        if (!first) first = result.totals.digest;
        EXPECT_EQ(result.totals.digest, *first) << "radius " << radius;
      });
    }
  }
}

TEST(NearCells, NamedLatticesAndSmallIntegerBasesTakeThem) {
  for (const Lattice& lattice : LatticesOfSmallCells()) {
    const Supercover supercover(IntegerCell::Of(lattice).value());
    ASSERT_NE(supercover.near_cells(), nullptr);
    EXPECT_GE(supercover.near_cells()->most_extent(), 12 * kLatticeUnit);
  }
  EXPECT_NE(Supercover(IntegerCell::Of(Lattice::Named(NamedLattice::kHexagonal)).value()).near_cells(), nullptr);
  // Boxes have a way of their own, and cells that are rounded to 30 bits go row by row.
  EXPECT_EQ(Supercover(IntegerCell::Of(Lattice::Named(NamedLattice::kCartesian)).value()).near_cells(), nullptr);
  const Lattice skew = Lattice::FromBasis({{{1, 0.1, 0.03}, {0.37, 1.21, -0.2}, {0.21, -0.43, 0.94}}}).value();
  EXPECT_EQ(Supercover(IntegerCell::Of(skew).value()).near_cells(), nullptr);
}

}  // namespace
}  // namespace latvox
