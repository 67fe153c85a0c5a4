// Solids equal the exact oracle, along directions that the core does not use. Some have volumes that can be counted by
// hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "core/block/tile_job.h"
#include "core/solid/balance.h"
#include "core/solid/interior.h"
#include "core/triangles/surface_facts.h"
#include "core/voxelizer/estimate.h"
#include "core/voxelizer/voxelizer.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/solid/line_fill.h"
#include "tests/unit/core/sphere.h"

namespace latvox {
namespace {

constexpr InteriorRule kRules[] = {InteriorRule::kParity, InteriorRule::kWinding, InteriorRule::kPositive};

oracle::Mesh Cube(int64_t n) { return Box({0, 0, 0}, {256 * n, 256 * n, 256 * n}); }

// Several bodies each, nested, touching, crossing each other, doubled, and inside out, on and off lattice points.
std::vector<oracle::Mesh> RandomSolids() {
  std::vector<oracle::Mesh> meshes;
  std::mt19937 random(7);
  for (int n = 0; n < 12; ++n) {
    const int64_t grain = n % 3 == 0 ? 256 : n % 3 == 1 ? 128 : 1;
    std::uniform_int_distribution<int64_t> coordinate(0, 6 * 256 / grain);
    oracle::Mesh mesh;
    for (int body = 0; body < 1 + n % 4; ++body) {
      std::array<Int3, 4> v;
      for (Int3& p : v) p = {coordinate(random) * grain, coordinate(random) * grain, coordinate(random) * grain};
      AddTetrahedron(v, random() % 4 == 0, mesh);
      if (random() % 5 == 0) AddTetrahedron(v, random() % 2 == 0, mesh);
    }
    meshes.push_back(mesh);
  }
  oracle::Mesh nested = Box({0, 0, 0}, {1600, 1600, 1600});
  for (const auto& inner : {Box({256, 256, 256}, {1344, 1344, 1344}), Box({512, 300, 512}, {1100, 1600, 1100})}) {
    nested.insert(nested.end(), inner.begin(), inner.end());
  }
  meshes.push_back(nested);
  return meshes;
}

Result VoxelizeSolid(const TriangleMesh& mesh, const Lattice& lattice, const Solid& solid, int threads = 2) {
  return Voxelize(mesh, Unscaled(lattice), {.set = solid}, threads);
}

class SolidOnLattice : public testing::TestWithParam<ExactLattice> {};

INSTANTIATE_TEST_SUITE_P(Exact, SolidOnLattice, testing::ValuesIn(RestoredLattices()),
                         [](const auto& lattice) { return lattice.param.name; });

// With and without tile borders through the middle; on one thread, which digitizes blocks of tiles, and on two.
TEST_P(SolidOnLattice, EqualsTheOracleAlongEveryDirection) {
  const Lattice& lattice = GetParam().lattice;
  for (const oracle::Mesh& mesh : RandomSolids()) {
    for (const InteriorRule rule : kRules) {
      const LineFill expected = FillAlong(mesh, {1, 1, 0}, rule);
      EXPECT_EQ(expected.unbalanced, 0U);
      for (const Int3& q : {Int3{1, 0, 0}, Int3{0, 1, 0}, Int3{0, 0, 1}}) {
        EXPECT_EQ(FillAlong(mesh, q, rule).inside, expected.inside);
      }
      for (const Vec3i& shift : {Vec3i{0, 0, 0}, Vec3i{62, 60, 61}, Vec3i{-68, 1022, -1}}) {
        for (const int threads : {1, 2}) {
          const TriangleMesh world = ToWorld(mesh, lattice, shift);
          const Result solid = VoxelizeSolid(world, lattice, {rule, SolidSurface::kNone}, threads);
          ASSERT_EQ(VoxelsOf(solid, shift), expected.inside) << NameOf(rule) << shift[0];
          const Result both = VoxelizeSolid(world, lattice, {rule}, threads);
          auto all = VoxelsOf(Voxelize(world, Unscaled(lattice), {}), shift);
          all.insert(expected.inside.begin(), expected.inside.end());
          ASSERT_EQ(VoxelsOf(both, shift), all) << NameOf(rule) << shift[0];
        }
      }
    }
  }
}

TEST_P(SolidOnLattice, FillsMeshesThatAreNotClosedLineByLineIfForced) {
  const Lattice& lattice = GetParam().lattice;
  std::mt19937 random(5);
  for (oracle::Mesh mesh : RandomSolids()) {
    mesh.erase(mesh.begin() + random() % mesh.size());
    for (const InteriorRule rule : kRules) {
      const LineFill expected = FillAlong(mesh, {0, 0, 1}, rule);
      for (const Vec3i& shift : {Vec3i{0, 0, 0}, Vec3i{62, 60, 61}}) {
        const TriangleMesh world = ToWorld(mesh, lattice, shift);
        auto job = VoxelizeJob::Create(world, Unscaled(lattice), {.set = Solid{rule, SolidSurface::kNone, true}});
        ASSERT_TRUE(job.ok() && (*job)->Prepare().ok());
        EXPECT_EQ((*job)->facts().unbalanced_lines, expected.unbalanced);
        const Result solid =
            VoxelizeSolid(world, lattice, {.rule = rule, .surface = SolidSurface::kNone, .force_open = true});
        ASSERT_EQ(VoxelsOf(solid, shift), expected.inside) << NameOf(rule) << shift[0];
      }
    }
  }
}

// The shift makes the rule half open on every lattice: a face through lattice points has all of them on one side.
TEST_P(SolidOnLattice, OfACubeHasItsVolumeInVoxels) {
  const Lattice& lattice = GetParam().lattice;
  for (const int64_t n : {1, 7, 64, 70}) {
    for (const InteriorRule rule : kRules) {
      const Result solid = VoxelizeSolid(ToWorld(Cube(n), lattice, {-3, 60, 0}), lattice,
                                         {.rule = rule, .surface = SolidSurface::kNone});
      EXPECT_EQ(solid.totals.voxels, static_cast<uint64_t>(n * n * n));
    }
  }
}

TEST(InteriorRules, DifferWhereBodiesOverlap) {
  oracle::Mesh mesh = Box({0, 0, 0}, {2560, 2560, 2560});  // 10^3
  const oracle::Mesh other = Box({1280, 0, 0}, {3840, 2560, 2560});
  mesh.insert(mesh.end(), other.begin(), other.end());
  const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  const TriangleMesh world = ToWorld(mesh, lattice);
  EXPECT_EQ(
      VoxelizeSolid(world, lattice, {.rule = InteriorRule::kParity, .surface = SolidSurface::kNone}).totals.voxels,
      1000U);
  EXPECT_EQ(
      VoxelizeSolid(world, lattice, {.rule = InteriorRule::kWinding, .surface = SolidSurface::kNone}).totals.voxels,
      1500U);
  EXPECT_EQ(
      VoxelizeSolid(world, lattice, {.rule = InteriorRule::kPositive, .surface = SolidSurface::kNone}).totals.voxels,
      1500U);
}

TEST(InteriorRules, DifferWhereBodiesAreTurnedInsideOut) {
  const auto turned = [](oracle::Mesh mesh) {
    for (auto& triangle : mesh) std::swap(triangle[1], triangle[2]);
    return mesh;
  };
  const oracle::Mesh outer = Box({0, 0, 0}, {2560, 2560, 2560}), inner = Box({768, 768, 768}, {1792, 1792, 1792});
  const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  const auto count = [&](oracle::Mesh mesh, const oracle::Mesh& more, InteriorRule rule) {
    mesh.insert(mesh.end(), more.begin(), more.end());
    return VoxelizeSolid(ToWorld(mesh, lattice), lattice, {.rule = rule, .surface = SolidSurface::kNone}).totals.voxels;
  };
  for (const InteriorRule rule : {InteriorRule::kAuto, InteriorRule::kWinding, InteriorRule::kPositive}) {
    EXPECT_EQ(count(outer, turned(inner), rule), 1000U - 64U) << NameOf(rule);  // a cavity
    EXPECT_EQ(count(outer, inner, rule), 1000U) << NameOf(rule);
  }
  EXPECT_EQ(count(turned(outer), {}, InteriorRule::kWinding), 1000U);
  EXPECT_EQ(count(turned(outer), {}, InteriorRule::kPositive), 0U);
}

// One triangle that is turned around makes a mesh that is closed, and not oriented.
TEST(InteriorRules, AutoIsWindingForOrientedMeshesOtherwiseParity) {
  const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  oracle::Mesh mesh = Box({0, 0, 0}, {2560, 2560, 2560});
  const oracle::Mesh other = Box({1280, 0, 0}, {3840, 2560, 2560});
  mesh.insert(mesh.end(), other.begin(), other.end());
  const auto check = [&](InteriorRule rule) {
    const TriangleMesh world = ToWorld(mesh, lattice);
    auto job = VoxelizeJob::Create(world, Unscaled(lattice), {.set = Solid{.surface = SolidSurface::kNone}});
    ASSERT_TRUE(job.ok() && (*job)->Prepare().ok());
    EXPECT_EQ((*job)->facts().interior_rule, rule);
    EXPECT_EQ(VoxelizeSolid(world, lattice, {.rule = InteriorRule::kAuto, .surface = SolidSurface::kNone})
                  .totals.digest.ToHex(),
              VoxelizeSolid(world, lattice, {.rule = rule, .surface = SolidSurface::kNone}).totals.digest.ToHex());
  };
  check(InteriorRule::kWinding);
  std::swap(mesh[0][1], mesh[0][2]);
  check(InteriorRule::kParity);
}

SnappedMesh Snapped(const oracle::Mesh& mesh, const Lattice& lattice) {
  return *Snap(ToWorld(mesh, lattice), lattice, {0, 0, 0}, ReachOf(lattice.frames(0)));
}

TEST(Balance, CountsLinesThroughHoles) {
  const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  const oracle::Mesh cube = Cube(100);
  const auto without = [&](size_t face) {
    oracle::Mesh mesh = cube;
    mesh.erase(mesh.begin() + static_cast<ptrdiff_t>(2 * face), mesh.begin() + static_cast<ptrdiff_t>(2 * face + 2));
    return Snapped(mesh, lattice);
  };
  for (const InteriorRule rule : kRules) {
    EXPECT_EQ(CountUnbalancedLines(Snapped(cube, lattice), rule), 0U);
    EXPECT_EQ(CountUnbalancedLines(without(0), rule), 10000U);
    EXPECT_EQ(CountUnbalancedLines(without(1), rule), 10000U);
    EXPECT_EQ(CountUnbalancedLines(without(2), rule), 0U);  // this face is parallel to the lines along k
    EXPECT_FALSE(FactsOf(without(2)).closed);
  }
  EXPECT_TRUE(IsOriented(Snapped(cube, lattice)));
  EXPECT_FALSE(IsOriented(without(0)));
  EXPECT_FALSE(IsOriented(without(2)));
}

TEST(Balance, OfOneTriangleTheOtherWayRoundIsThatOfParityAlone) {
  const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  oracle::Mesh mesh = Cube(10);
  // A triangle of the lower face: half of the lines. The shift decides whether those of the diagonal are among them.
  std::swap(mesh[0][0], mesh[0][1]);
  const SnappedMesh snapped = Snapped(mesh, lattice);
  EXPECT_TRUE(FactsOf(snapped).closed);
  EXPECT_FALSE(IsOriented(snapped));
  EXPECT_EQ(CountUnbalancedLines(snapped, InteriorRule::kParity), 0U);
  const uint64_t lines = CountUnbalancedLines(snapped, InteriorRule::kWinding);
  EXPECT_TRUE(lines == 45 || lines == 55) << lines;
  EXPECT_EQ(
      VoxelizeSolid(ToWorld(mesh, lattice), lattice, {.rule = InteriorRule::kParity, .surface = SolidSurface::kNone})
          .totals.voxels,
      1000U);
  const auto job =
      VoxelizeJob::Create(ToWorld(mesh, lattice), Unscaled(lattice), {.set = Solid{.rule = InteriorRule::kWinding}});
  EXPECT_EQ((*job)->Prepare().message().substr(0, 67),
            "mesh: it is not closed with one orientation, as the rule winding as");
}

// Tests both ways to find the interior, on tiles with and without surface.
TEST(Interiors, OfClosedMeshesAreTheSameLineByLine) {
  const Lattice lattice = Lattice::Named(NamedLattice::kBcc);
  const SnappedMesh mesh = *Snap(Sphere(30, 200), lattice, {0, 0, 0}, ReachOf(lattice.frames(0)));
  std::vector<uint32_t> triangles(mesh.triangles.size());
  for (uint32_t t = 0; t < triangles.size(); ++t) triangles[t] = t;
  const Vec3i low = mesh.box.min, side{8 * kTileSide, 8 * kTileSide, 8 * kTileSide};
  for (const InteriorRule rule : kRules) {
    const auto closed = MakeClosedInterior(mesh, rule, {low, low + side});
    const auto open = MakeOpenInterior(mesh, rule, {low, low + side});
    InteriorRows a, b;
    for (int32_t n = 0; n < 512; ++n) {
      const Vec3i tile = Shifted(low, kTileBits) + Vec3i{n >> 6, n >> 3 & 7, n & 7};
      closed->Find(tile, triangles, a);
      open->Find(tile, triangles, b);
      ASSERT_TRUE(std::equal(a.view().begin(), a.view().end(), b.view().begin()));
      EXPECT_TRUE((a.view()[0] & 1) == 0 || (closed->MayHold(tile, 0) && open->MayHold(tile, 0)));
    }
  }
}

struct Part {
  const char* name;
  NamedLattice lattice;
  Solid solid;
};

constexpr Part kParts[] = {{"all", NamedLattice::kBcc, {}},
                           {"interior", NamedLattice::kHexagonal, {InteriorRule::kWinding, SolidSurface::kNone}},
                           {"forced", NamedLattice::kFcc, {InteriorRule::kParity, SolidSurface::kNone, true}}};

TriangleMesh MeshOf(const Part& part, float radius) {
  TriangleMesh mesh = Sphere(20, radius);
  if (part.solid.force_open) mesh.triangles.resize(mesh.triangles.size() - 40);
  return mesh;
}

// This also holds for regions without a triangle near their middle.
TEST(Solids, AreTheUnionOfTheirParts) {
  for (const Part& part : kParts) {
    const TriangleMesh mesh = MeshOf(part, 130);
    const Grid grid = Unscaled(Lattice::Named(part.lattice));
    for (const auto& region : {std::optional<IndexBox>(), std::optional(IndexBox{{-30, -41, -70}, {65, 99, 40}})}) {
      const VoxelizeOptions options{.region = region, .set = part.solid};
      const Result whole = Voxelize(mesh, grid, options, 1);
      EXPECT_GT(whole.totals.voxels, 100000U) << part.name;
      EXPECT_EQ(Voxelize(mesh, grid, options, 3).totals.digest, whole.totals.digest) << part.name;
      Digest sum;
      uint64_t tiles = 0;
      for (uint32_t index = 0; index < 3; ++index) {
        VoxelizeOptions shard = options;
        shard.shard = Shard{index, 3};
        const Result some = Voxelize(mesh, grid, shard, index % 2 == 0 ? 1 : 3);
        sum.Add(some.totals.digest);
        for (const TileBricks& tile : some.tiles) EXPECT_EQ(tile.tile_ijk, whole.tiles[tiles++].tile_ijk) << part.name;
      }
      EXPECT_EQ(sum, whole.totals.digest) << part.name;
      Digest delivered;
      for (size_t n = 0; n < whole.tiles.size(); ++n) {
        for (const Brick& brick : whole.tiles[n].bricks) delivered.Add(brick);
        if (n % 31 != 5) continue;
        VoxelizeOptions rest = options;
        rest.resume_after = whole.tiles[n].tile_ijk;
        Digest total = delivered;
        total.Add(Voxelize(mesh, grid, rest).totals.digest);
        EXPECT_EQ(total, whole.totals.digest) << part.name;
      }
    }
  }
}

TEST(Solids, OfARegionAreTheWholesVoxelsInIt) {
  const IndexBox region{{-30, -41, -70}, {35, 99, 40}};
  for (const Part& part : kParts) {
    const Grid grid = Unscaled(Lattice::Named(part.lattice));
    auto whole = VoxelsOf(Voxelize(MeshOf(part, 45), grid, {.set = part.solid}));
    std::erase_if(whole, [&](const Int3& z) {
      return !region.Contains({static_cast<int32_t>(z[0]), static_cast<int32_t>(z[1]), static_cast<int32_t>(z[2])});
    });
    EXPECT_EQ(VoxelsOf(Voxelize(MeshOf(part, 45), grid, {.region = region, .set = part.solid})), whole) << part.name;
  }
}

// Deep inside, cubes of many tiles begin below the region, and no triangle comes near.
TEST(Solids, OfASmallRegionDeepInsideAreAllOfIt) {
  const IndexBox region{{-237, 41, -45}, {-228, 50, -36}};
  for (const Part& part : kParts) {
    if (part.solid.force_open) continue;
    const Result result =
        Voxelize(MeshOf(part, 900), Unscaled(Lattice::Named(part.lattice)), {.region = region, .set = part.solid});
    EXPECT_EQ(result.totals.voxels, 729U) << part.name;
  }
}

TEST(Solids, MayHaveASupercoverForSurface) {
  for (const Part& part : kParts) {
    const Grid grid = Unscaled(Lattice::Named(part.lattice));
    if (part.solid.surface == SolidSurface::kNone) continue;
    Solid interior = part.solid, solid = part.solid;
    solid.surface = SolidSurface::kSupercover;
    interior.surface = SolidSurface::kNone;
    auto both = VoxelsOf(Voxelize(MeshOf(part, 45), grid, {.set = interior}));
    const auto cover = VoxelsOf(Voxelize(MeshOf(part, 45), grid, {.set = SupercoverSurface{}}));
    both.insert(cover.begin(), cover.end());
    EXPECT_EQ(VoxelsOf(Voxelize(MeshOf(part, 45), grid, {.set = solid})), both) << part.name;
  }
}

TEST(Solids, AreTheSameForAllKernels) {
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kFcc));
  std::set<std::string> digests;
  for (const Simd simd : SimdHere()) {
    const ForcedSimd forced(simd);
    digests.insert(Voxelize(Sphere(200, 100), grid, {.set = Solid{}}).totals.digest.ToHex());
  }
  EXPECT_EQ(digests.size(), 1U);
}

TEST(Solids, ComeInCanonicalOrderWithProgress) {
  const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  const TriangleMesh mesh = Sphere(10, 300);
  const auto job = VoxelizeJob::Create(mesh, Unscaled(lattice), {.set = Solid{}});
  ASSERT_TRUE(job.ok());
  const Result solid = VoxelizeSolid(mesh, lattice, {});
  double progress = 0;
  uint64_t last = 0;
  for (const TileBricks& tile : solid.tiles) {
    const uint64_t number = Morton(tile.tile_ijk - (*job)->facts().first_tile_ijk);
    EXPECT_TRUE(number > last || &tile == &solid.tiles.front());
    last = number;
    EXPECT_GE(tile.progress, progress);
    EXPECT_LE(tile.progress, 1);
    progress = tile.progress;
  }
  EXPECT_GT(std::count_if(solid.tiles.begin(), solid.tiles.end(), [](const auto& t) { return t.voxels == 64 * 4096; }),
            20);
}

// No solid has more voxels than estimated, and the estimate is not far off.
TEST(Solids, AreEstimated) {
  for (const NamedLattice name : {NamedLattice::kCartesian, NamedLattice::kBcc}) {
    const Grid grid = Unscaled(Lattice::Named(name));
    for (const TriangleMesh& mesh : {Sphere(20, 100), ToWorld(Cube(150), grid.lattice)}) {
      const VoxelizeOptions options{.set = Solid{}};
      const auto voxels = static_cast<double>(Voxelize(mesh, grid, options).totals.voxels);
      const double estimate = EstimateVoxels(mesh, ExtentOf(mesh), grid, *MakeRequest(options));
      EXPECT_LE(voxels, estimate);
      EXPECT_GE(3 * voxels, estimate);
    }
  }
}

}  // namespace
}  // namespace latvox
