// Where cells are boxes, all ways to find a supercover give the voxels of Supercover, on each kernel.
#include "core/supercover/box_cells.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "tests/unit/core/exact.h"
#include "tests/unit/core/simd.h"
#include "tests/unit/core/supercover/row_by_row.h"

namespace latvox {
namespace {

using oracle::Int3;

// From triangles within a cell to some that reach over several tiles, in general position and on the corners, edges and
// facets of cells.
TEST(BoxCells, AllWaysGiveTheVoxelsOfEachTriangleRowByRow) {
  std::mt19937 random(11);
  for (const Mat3d& basis : {Mat3d{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, Mat3d{{{0, 2, 0}, {1, 0, 0}, {0, 0, 4}}}}) {
    const Lattice lattice = Lattice::FromBasis(basis).value();
    ASSERT_FALSE(Supercover(IntegerCell::Of(lattice).value()).scan_frames().empty());
    for (const auto& [extent, count] : std::vector<std::pair<int64_t, size_t>>{
             {100, 300}, {400, 300}, {1000, 100}, {3000, 40}, {9000, 8}, {40000, 2}}) {
      for (const int64_t grain : {1, 16, 128, 256}) {
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

TEST(BoxCells, OnlyBoxesAlongTheLatticeAxesAreScanned) {
  for (const NamedLattice name : {NamedLattice::kBcc, NamedLattice::kFcc, NamedLattice::kHexagonal}) {
    EXPECT_TRUE(Supercover(IntegerCell::Of(Lattice::Named(name)).value()).scan_frames().empty());
  }
  // The Cartesian lattice in a basis that is not reduced has cubes that lie askew to the lattice axes.
  const Lattice sheared = Lattice::FromBasis({{{1, 0, 0}, {1, 1, 0}, {0, 0, 1}}}).value();
  EXPECT_TRUE(Supercover(IntegerCell::Of(sheared).value()).scan_frames().empty());
}

TEST(BoxCells, NearlyAllTrianglesInGeneralPositionAreScanned) {
  std::mt19937 random(12);
  size_t scanned = 0;
  const oracle::Mesh mesh = RandomTriangles(1, 3000, 4000, random);
  for (const oracle::Triangle& triangle : mesh) scanned += ScanFindsCover(FromOracle(triangle)) ? 1 : 0;
  EXPECT_GT(scanned, 3900U);
  EXPECT_LT(scanned, 4000U);
}

TEST(BoxCells, TrianglesThatTouchCellsOrHaveNoAreaAreNotScanned) {
  const Triangle flat{{{0, 0, 0}, {500, 700, 900}, {1000, 1400, 1800}}};
  EXPECT_FALSE(ScanFindsCover(flat));
  // Between two layers of voxels, and a little above.
  EXPECT_FALSE(ScanFindsCover({{{10, 20, 128}, {1523, 31, 128}, {7, 1533, 128}}}));
  EXPECT_TRUE(ScanFindsCover({{{10, 20, 129}, {1523, 31, 129}, {7, 1533, 129}}}));
  // An edge along the edges of a row of cells, and a little above.
  EXPECT_FALSE(ScanFindsCover({{{10, 128, 128}, {1523, 128, 128}, {7, 1533, 171}}}));
  EXPECT_TRUE(ScanFindsCover({{{10, 128, 129}, {1523, 128, 129}, {7, 1533, 172}}}));
  // A height field with a vertex for each voxel: only the division by common divisors shows that nothing touches.
  EXPECT_TRUE(ScanFindsCover({{{5, 7, 33}, {261, 7, 50}, {5, 263, 71}}}));
}

}  // namespace
}  // namespace latvox
