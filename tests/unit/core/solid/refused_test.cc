// Meshes that are not closed have no solid, and the error says why.
#include <gtest/gtest.h>

#include "core/voxelizer/voxelizer.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/solid/line_fill.h"

namespace latvox {
namespace {

oracle::Mesh Cube(int64_t n) { return Box({0, 0, 0}, {256 * n, 256 * n, 256 * n}); }

TEST(Solids, WithoutOneSideAreRefusedWhereverItIs) {
  const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  size_t balanced = 0;
  for (int side = 0; side < 6; ++side) {
    oracle::Mesh mesh = Cube(10);
    mesh.erase(mesh.begin() + 2 * side, mesh.begin() + 2 * side + 2);
    auto job = VoxelizeJob::Create(ToWorld(mesh, lattice), Unscaled(lattice), {.set = Solid{}});
    ASSERT_TRUE(job.ok());
    const absl::Status status = (*job)->Prepare();
    if (status.message() ==
        "mesh: it is not closed, although all lattice lines along k end balanced; force_open fills "
        "along these lines") {
      ++balanced;
    } else {
      EXPECT_EQ(status.message(),
                "mesh: it is not closed, and 100 lattice lines along k end unbalanced; force_open fills the others");
    }
  }
  EXPECT_EQ(balanced, 4U);
}

TEST(Solids, OfMeshesThatAreNotClosedAreRefused) {
  const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  oracle::Mesh mesh = Cube(10);
  mesh.erase(mesh.begin() + 2, mesh.begin() + 4);
  auto job = VoxelizeJob::Create(ToWorld(mesh, lattice), Unscaled(lattice), {.set = Solid{}});
  ASSERT_TRUE(job.ok());
  for (const absl::Status& status : {(*job)->Prepare(), (*job)->Advance([](TileBricks&&) { return true; }).status()}) {
    EXPECT_EQ(status, absl::InvalidArgumentError("mesh: it is not closed, and 100 lattice lines along k end "
                                                 "unbalanced; force_open fills the others"));
  }
  EXPECT_FALSE(VoxelizeJob::Create(ToWorld(mesh, lattice), Unscaled(lattice),
                                   {.algorithm = Algorithm::kBruteForce, .set = Solid{}})
                   .ok());
}

}  // namespace
}  // namespace latvox
