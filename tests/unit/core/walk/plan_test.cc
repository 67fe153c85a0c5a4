// The lattice point nearest to the start of a walk.
#include "core/walk/plan.h"

#include <gtest/gtest.h>

#include "core/base/status_payload.h"
#include "core/lattice/lattice.h"
#include "core/voxelizer/voxelizer.h"
#include "tests/unit/core/sphere.h"

namespace latvox {
namespace {

Vec3i Nearest(const Grid& grid, const Vec3d& world) {
  const auto nearest = NearestPoint(grid, world, "seed");
  EXPECT_TRUE(nearest.ok()) << nearest.status();
  return nearest.value_or(Vec3i{});
}

TEST(NearestPoint, IsTheFirstOfSeveralEquallyNear) {
  const Grid grid{Lattice::Named(NamedLattice::kCartesian), {0.25, 0, 0}};
  EXPECT_EQ(Nearest(grid, {3.5, 7, -2}), (Vec3i{3, 7, -2}));
  EXPECT_EQ(Nearest(grid, {3.75, 7.5, -2.5}), (Vec3i{3, 7, -3}));
  const Grid bcc{Lattice::Named(NamedLattice::kBcc), {0, 0, 0}};
  for (const Vec3i& ijk : {Vec3i{0, 0, 0}, Vec3i{5, -3, 2}}) {
    EXPECT_EQ(Nearest(bcc, Apply(bcc.lattice.basis(), ToDouble(ijk))), ijk);
  }
}

// In sums with such origins, all points near the start are equally near.
TEST(NearestPoint, OfAFarOriginIsFound) {
  const Lattice lattice = Lattice::Named(NamedLattice::kFcc);
  EXPECT_EQ(Nearest({lattice, {1e300, 1e300, 1e300}}, {1e300, 1e300, 1e300}), (Vec3i{0, 0, 0}));
  EXPECT_EQ(Nearest({lattice, {1e25, 0, -1e25}}, {1e25, 0, -1e25}), (Vec3i{0, 0, 0}));
}

// Their squares are beyond doubles.
TEST(NearestPoint, OfAnySizeOfVoxelsIsFound) {
  for (const double size : {1e-95, 1e-60, 1e60, 1e95}) {
    const auto lattice = Lattice::FromBasis({{{size, 0, 0}, {0, size, 0}, {0, 0, size}}});
    ASSERT_TRUE(lattice.ok()) << size << lattice.status();
    EXPECT_EQ(Nearest({*lattice, {0, 0, 0}}, {3.4 * size, -7.5 * size, 2 * size}), (Vec3i{3, -8, 2}));
  }
}

// A job looks for the point before any limit is checked.
TEST(NearestPoint, IsRefusedBeyondLatticeCoordinates) {
  const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  const TriangleMesh mesh = Sphere(5, 5);
  const auto refusal = [&](const Vec3d& origin, const SetOption& set) {
    return VoxelizeJob::Create(mesh, {lattice, origin}, {.set = set}).status();
  };
  const absl::Status far = refusal({0, 0, 0}, Enclosed{.leak_from = Vec3d{0, -1e9, 0}});
  EXPECT_EQ(far.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(far.message(),
            "enclosed.leak_from: it lies at lattice coordinate -1e+09 on axis j, the limit is 536870912");
  EXPECT_EQ(far.GetPayload(kRefusedValue), absl::Cord("-1000000000"));
  EXPECT_EQ(far.GetPayload(kRefusedLimit), absl::Cord("536870912"));
  EXPECT_EQ(refusal({1e300, 0, 0}, Connected{.seed = {-1e300, 0, 0}}).message(),
            "connected.seed: it lies at lattice coordinate -2e+300 on axis i, the limit is 536870912");
  for (const double at : {1e25, 1e300}) {  // the start has a place, and the mesh has none
    const Vec3d origin{at, at, at};
    for (const SetOption& set : {SetOption(Connected{.seed = origin}), SetOption(Enclosed{.leak_from = origin})}) {
      EXPECT_EQ(refusal(origin, set).message().substr(0, 7), "origin:");
    }
  }
}

}  // namespace
}  // namespace latvox
