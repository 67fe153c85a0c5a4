// The lattice point nearest to the start of a walk.
#include "core/walk/plan.h"

#include <gtest/gtest.h>

#include "core/lattice/lattice.h"

namespace latvox {
namespace {

TEST(NearestPoint, IsTheFirstOfSeveralEquallyNear) {
  const Grid grid{Lattice::Named(NamedLattice::kCartesian), {0.25, 0, 0}};
  EXPECT_EQ(NearestPoint(grid, {3.5, 7, -2}), (Vec3i{3, 7, -2}));
  EXPECT_EQ(NearestPoint(grid, {3.75, 7.5, -2.5}), (Vec3i{3, 7, -3}));
  const Grid bcc{Lattice::Named(NamedLattice::kBcc), {0, 0, 0}};
  for (const Vec3i& ijk : {Vec3i{0, 0, 0}, Vec3i{5, -3, 2}}) {
    EXPECT_EQ(NearestPoint(bcc, Apply(bcc.lattice.basis(), ToDouble(ijk))), ijk);
  }
}

// In sums with such origins, all points near the start are equally near.
TEST(NearestPoint, OfAFarOriginIsFound) {
  const Lattice lattice = Lattice::Named(NamedLattice::kFcc);
  EXPECT_EQ(NearestPoint({lattice, {1e300, 1e300, 1e300}}, {1e300, 1e300, 1e300}), (Vec3i{0, 0, 0}));
  EXPECT_EQ(NearestPoint({lattice, {1e25, 0, -1e25}}, {1e25, 0, -1e25}), (Vec3i{0, 0, 0}));
  const Vec3i far = NearestPoint({lattice, {1e300, 0, 0}}, {-1e300, 0, 0});
  EXPECT_LT(far[0], -(1 << 29));
}

// Their squares are beyond doubles.
TEST(NearestPoint, OfAnySizeOfVoxelsIsFound) {
  for (const double size : {1e-95, 1e-60, 1e60, 1e95}) {
    const auto lattice = Lattice::FromBasis({{{size, 0, 0}, {0, size, 0}, {0, 0, size}}});
    ASSERT_TRUE(lattice.ok()) << size << lattice.status();
    EXPECT_EQ(NearestPoint({*lattice, {0, 0, 0}}, {3.4 * size, -7.5 * size, 2 * size}), (Vec3i{3, -8, 2}));
  }
}

}  // namespace
}  // namespace latvox
