// The pipeline equals the exact oracle, on every kind of lattice.
#include <gtest/gtest.h>

#include "core/voxelizer/voxelizer.h"
#include "tests/unit/core/exact.h"

namespace latvox {
namespace {

// One thread digitizes tiles in blocks. Several threads digitize so few tiles one by one.
int Threads(Simd simd) { return simd == Simd::kScalar || simd == Simd::kAvx2 ? 2 : 1; }

class PipelineOnLattice : public testing::TestWithParam<ExactLattice> {};

INSTANTIATE_TEST_SUITE_P(Exact, PipelineOnLattice, testing::ValuesIn(ExactLattices()),
                         [](const auto& lattice) { return lattice.param.name; });

TEST_P(PipelineOnLattice, EqualsTheOracleOnAdversarialMeshes) {
  const ExactLattice& l = GetParam();
  for (int k : {0, 1, 2}) {
    const auto directions = Directions(l.lattice.frames(k));
    if (k > 0 && directions == Directions(l.lattice.frames(k - 1))) continue;
    for (const auto& mesh : oracle::AdversarialMeshes(static_cast<uint64_t>(10 + k), directions)) {
      for (bool minimal : {false, true}) {
        VoxelizeOptions options{.separability = k, .minimal = minimal, .region = std::nullopt};
        if (mesh.box) {
          options.region.emplace();
          for (size_t m = 0; m < 3; ++m) {
            options.region->min[m] = static_cast<int32_t>(mesh.box->lo[m]);
            options.region->max[m] = static_cast<int32_t>(mesh.box->hi[m] + 1);
          }
        }
        const auto expected = oracle::Digitize(mesh.triangles, directions, minimal, mesh.box);
        for (const Simd simd : SimdHere()) {
          const ForcedSimd forced(simd);
          const auto result = Voxelize(ToWorld(mesh.triangles, l.lattice), Unscaled(l.lattice), options, Threads(simd));
          ASSERT_EQ(VoxelsOf(result), expected)
              << l.name << " k " << k << " minimal " << minimal << " " << mesh.name << " " << SimdInUse();
        }
      }
    }
  }
}

// A move of the mesh by whole voxels moves the result with it, wherever tile borders lie. Even steps keep the parity
// classes.
TEST_P(PipelineOnLattice, DoesNotDependOnWhereTileBordersLie) {
  const ExactLattice& l = GetParam();
  const auto directions = Directions(l.lattice.frames(0));
  for (const auto& mesh : oracle::AdversarialMeshes(21, directions)) {
    if (mesh.box) continue;
    const auto expected = oracle::Digitize(mesh.triangles, directions, true);
    for (const Vec3i& shift : {Vec3i{62, -2, 30}, Vec3i{-64, 60, 66}, Vec3i{1000, -5000, 126}}) {
      for (const Simd simd : SimdHere()) {
        const ForcedSimd forced(simd);
        const auto result = Voxelize(ToWorld(mesh.triangles, l.lattice, shift), Unscaled(l.lattice), {}, Threads(simd));
        ASSERT_EQ(VoxelsOf(result, shift), expected)
            << l.name << " " << mesh.name << " shift " << shift[0] << " " << SimdInUse();
      }
    }
  }
}

}  // namespace
}  // namespace latvox
