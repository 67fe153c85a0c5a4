// The estimates of a job's cost.
#include "core/voxelizer/estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <variant>
#include <vector>

#include "core/snap/snap.h"
#include "core/voxelizer/voxelizer.h"
#include "core/voxelizer/walk_estimate.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/sphere.h"
#include "tests/unit/core/walk/answers.h"

namespace latvox {
namespace {

// Triangles with a random corner, and others next to a second one.
TriangleMesh Needles(uint32_t count, float side, float thickness) {
  constexpr unsigned kSeed = 7;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> coordinate(0, side), near(-thickness, thickness);
  TriangleMesh mesh;
  for (uint32_t n = 0; n < count; ++n) {
    const Vec3f end = {coordinate(random), coordinate(random), coordinate(random)};
    mesh.vertices.push_back({coordinate(random), coordinate(random), coordinate(random)});
    mesh.vertices.push_back(end);
    mesh.vertices.push_back({end[0] + near(random), end[1] + near(random), end[2] + near(random)});
    mesh.triangles.push_back({3 * n, 3 * n + 1, 3 * n + 2});
  }
  return mesh;
}

// Small triangles far from each other.
TriangleMesh Dust(uint32_t count, float side) {
  TriangleMesh mesh = Needles(count, side, 0);
  for (size_t n = 0; n < mesh.vertices.size(); n += 3) {
    mesh.vertices[n + 1] = mesh.vertices[n] + Vec3f{1, 0, 0};
    mesh.vertices[n + 2] = mesh.vertices[n] + Vec3f{0, 1, 0};
  }
  return mesh;
}

TEST(EstimateVoxels, IsBetweenOneAndThreeTimesTheVoxelsOfASurface) {
  const TriangleMesh mesh = Sphere(40, 150);
  for (const NamedLattice lattice : {NamedLattice::kCartesian, NamedLattice::kBcc, NamedLattice::kFcc}) {
    for (const int k : {0, 2}) {
      const Grid grid = Unscaled(Lattice::Named(lattice));
      const auto voxels = static_cast<double>(Voxelize(mesh, grid, {.separability = k}).totals.voxels);
      const double estimate = EstimateVoxels(mesh, ExtentOf(mesh), grid, {.separability = k});
      EXPECT_GE(estimate, voxels);
      EXPECT_LE(estimate, 3 * voxels);
    }
  }
  const IndexBox box = {{0, 0, 0}, {10, 20, 30}};
  EXPECT_EQ(EstimateVoxels(mesh, ExtentOf(mesh), Unscaled(Lattice::Named(NamedLattice::kCartesian)),
                           {.part = {.region = box}}),
            6000);
}

TEST(EstimateVoxels, CountsNeedlesByTheirLength) {
  for (const NamedLattice lattice : {NamedLattice::kCartesian, NamedLattice::kBcc, NamedLattice::kFcc}) {
    const Grid grid = Unscaled(Lattice::Named(lattice));
    for (const float thickness : {0.03F, 0.1F, 0.5F}) {
      const TriangleMesh few = Needles(50, 60, thickness), many = Needles(20000, 60, thickness);
      const auto voxels = static_cast<double>(Voxelize(few, grid, {}).totals.voxels);
      const double estimate = EstimateVoxels(few, ExtentOf(few), grid, {});
      EXPECT_GE(2 * estimate, voxels) << thickness;
      EXPECT_LE(estimate, 3 * voxels) << thickness;
      // A needle costs a visit for each of its rows, at least.
      EXPECT_GT(EstimateVisits(many, ExtentOf(many), grid, {}), 20000 * 30) << thickness;
    }
  }
}

// A single needle among other triangles counts, and a mesh without any is not looked through.
TEST(EstimateVoxels, DependOnTheThinnestTriangle) {
  TriangleMesh mesh{
      {{40, 0, 0}, {-40, 0, 0}, {0, 40, 0}, {0, -40, 0}, {0, 0, 40}, {0, 0, -40}},
      {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}, {0, 0, 0}}};
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  const MeshExtent extent = ExtentOf(mesh);
  MeshExtent unknown = extent;
  unknown.thinnest = 0;
  EXPECT_NEAR(extent.thinnest, 40 * std::sqrt(1.5), 1e-5);
  EXPECT_EQ(EstimateVisits(mesh, extent, grid, {}), EstimateVisits(mesh, unknown, grid, {}));
  mesh.vertices.insert(mesh.vertices.end(), {{0, 0, 0}, {30, 0, 0}, {30, 0.25F, 0}});
  const auto last = static_cast<uint32_t>(mesh.vertices.size());
  mesh.triangles.push_back({last - 3, last - 2, last - 1});
  EXPECT_NEAR(ExtentOf(mesh).thinnest, 0.25, 0.01);
  EXPECT_GT(EstimateVisits(mesh, ExtentOf(mesh), grid, {}), EstimateVisits(mesh, extent, grid, {}) + 30);
  mesh.triangles.push_back({0, 0, 1});
  EXPECT_EQ(ExtentOf(mesh).thinnest, 0);
}

TEST(EstimateVoxels, CountsBothEndsOfLinks) {
  const TriangleMesh mesh = Sphere(40, 100);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  for (const LinkSide side : {LinkSide::kBoth, LinkSide::kOutside}) {
    const VoxelizeOptions options{.set = Links{side}, .fields = {Field::kLinks}};
    const auto voxels = static_cast<double>(Voxelize(mesh, grid, options).totals.voxels);
    const double estimate = EstimateVoxels(mesh, ExtentOf(mesh), grid, *MakeRequest(options));
    EXPECT_GE(estimate, voxels);
    EXPECT_LE(estimate, 3 * voxels);
    EXPECT_GT(EstimateVisits(mesh, ExtentOf(mesh), grid, *MakeRequest(options)), 10 * voxels);
  }
}

TEST(EstimateVisits, CountThinningWhereTrianglesFillAVolume) {
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  const auto visits = [&](const TriangleMesh& mesh, bool minimal) {
    return EstimateVisits(mesh, ExtentOf(mesh), grid, *MakeRequest({.minimal = minimal}));
  };
  const TriangleMesh sphere = Sphere(40, 150), full = Needles(20000, 60, 30);
  EXPECT_LT(visits(sphere, true), 1.1 * visits(sphere, false));
  // Twenty visits, at least, for each lattice point of the box.
  EXPECT_GT(visits(full, true), visits(full, false) + 20 * 60 * 60 * 60);
}

TEST(EstimateVisits, CountAllTrianglesOfAPart) {
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  const IndexBox box = {{26, 26, 26}, {34, 34, 34}};
  const TriangleMesh full = Needles(20000, 60, 30);
  const double whole = EstimateVisits(full, ExtentOf(full), grid, {});
  const double part = EstimateVisits(full, ExtentOf(full), grid, {.part = {.region = box}});
  EXPECT_GT(part, whole / 10000);  // it has 512 of some 120^3 points
  EXPECT_LT(part, whole / 1000);
  const TriangleMesh sphere = Sphere(40, 150);
  EXPECT_LE(EstimateVisits(sphere, ExtentOf(sphere), grid, {.part = {.region = box}}), 512);
}

// A shard or a small region of a solid or a walk takes the time before the first tile of the whole.
TEST(EstimateVisits, CountWhatComesBeforeTheFirstTile) {
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  const auto visits = [&](const TriangleMesh& mesh, const VoxelizeOptions& options) {
    const VoxelRequest request = MakeRequest(options).value();
    const MeshExtent extent = ExtentOf(mesh);
    return WithPreparation(EstimateVisits(mesh, extent, grid, request), request,
                           EstimateLineCrossings(mesh, grid, request),
                           MostWallTiles(mesh, extent, grid, request, MostWalks(mesh, request)));
  };
  constexpr float kSide = 16384;
  constexpr double kLines = (16384 / 64 + 1) * (16384 / 64 + 1);
  const TriangleMesh flat = ToWorld(Box({0, 0, 0}, {16384 * kLatticeUnit, 16384 * kLatticeUnit, kLatticeUnit}),
                                    Lattice::Named(NamedLattice::kCartesian));
  const Shard shard{0, kMaxShards};
  const IndexBox one{{0, 0, 0}, {1, 1, 1}};
  EXPECT_GT(visits(flat, {.shard = shard, .set = Solid{}}), 10 * kLines);
  EXPECT_LT(visits(flat, {.shard = shard, .set = Solid{}}), 40 * kLines);
  EXPECT_GT(visits(flat, {.region = one, .set = Solid{.force_open = true}}), 10 * kLines * 64 * 64);
  const TriangleMesh dust = Dust(1000, kSide);
  for (const double close : {0.0, 5.0}) {
    EXPECT_GT(visits(dust, {.region = one, .set = Enclosed{.close = close}}), 1000 * 4000);
    EXPECT_GT(visits(dust, {.shard = shard, .set = Enclosed{.close = close}}), 1000 * 4000);
    EXPECT_LT(visits(dust, {.region = one, .set = Enclosed{.close = close}}), 1000 * 60000);
  }
  // The estimates of other jobs stay as they are.
  const TriangleMesh sphere = Sphere(40, 50);
  for (const VoxelizeOptions& options :
       {VoxelizeOptions{}, {.set = Solid{}}, {.set = Solid{.force_open = true}}, {.set = Enclosed{}}}) {
    EXPECT_EQ(visits(sphere, options), EstimateVisits(sphere, ExtentOf(sphere), grid, MakeRequest(options).value()));
  }
}

TEST(EstimateMilliseconds, LeaveTheWorkOfFieldsToTheVisits) {
  const auto milliseconds = [](const VoxelizeOptions& options) {
    return EstimateMilliseconds(*MakeRequest(options), 1'000'000, 1'000'000);
  };
  const double plain = milliseconds({});
  EXPECT_GT(plain, 50);
  EXPECT_EQ(milliseconds({.fields = {Field::kTriangle}}), plain);
  EXPECT_EQ(milliseconds({.fields = {Field::kFraction}, .fraction_n = 8}), plain);
  EXPECT_GT(milliseconds({.set = Band{.width = 1}}), plain);  // each visit finds a distance
}

// A sphere, needles, and a triangle with many tiles.
TriangleMesh Mixture() {
  TriangleMesh mesh = Sphere(40, 50);
  const TriangleMesh needles = Needles(100, 60, 0.1F);
  const auto first = static_cast<uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), needles.vertices.begin(), needles.vertices.end());
  for (const auto& [a, b, c] : needles.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
  mesh.vertices.insert(mesh.vertices.end(), {{0, 0, 0}, {9000, 0, 0}, {0, 9000, 500}});
  mesh.triangles.push_back({first + 300, first + 301, first + 302});
  return mesh;
}

// All estimates for a mesh, voxels and options of so many times the size; lengths and areas over that size.
std::vector<double> EstimatesAt(double scale, const TriangleMesh& unscaled, NamedLattice lattice,
                                VoxelizeOptions options) {
  if (auto* const enclosed = std::get_if<Enclosed>(&options.set)) enclosed->close *= scale;
  TriangleMesh mesh;
  mesh.triangles = unscaled.triangles;
  for (const Vec3f& v : unscaled.vertices) mesh.double_vertices.push_back({v[0] * scale, v[1] * scale, v[2] * scale});
  const Grid grid{Lattice::Named(lattice).Scaled(scale).value(), {}};
  const VoxelRequest request = MakeRequest(options).value();
  const MeshExtent extent = ExtentOf(mesh);
  return {extent.area / scale / scale,
          extent.longest / scale,
          extent.thinnest / scale,
          EstimateVoxels(mesh, extent, grid, request),
          EstimateVisits(mesh, extent, grid, request),
          EstimateLineCrossings(mesh, grid, request),
          MostWallTiles(mesh, extent, grid, request, 1),
          MostWalkPoints(extent, grid, request)};
}

// In world units, products of a few lengths would under- or overflow.
TEST(Estimates, DoNotDependOnTheUnitOfLength) {
  const TriangleMesh mesh = Mixture();
  const std::vector<VoxelizeOptions> all{{},
                                         {.minimal = true},
                                         {.algorithm = Algorithm::kBruteForce},
                                         {.set = SupercoverSurface{}},
                                         {.set = Solid{}},
                                         {.set = Solid{.force_open = true}},
                                         {.set = Band{.width = 2, .in_voxels = true}},
                                         {.set = Enclosed{}},
                                         {.set = Enclosed{.close = 5}}};
  for (const NamedLattice lattice : {NamedLattice::kCartesian, NamedLattice::kBcc}) {
    for (size_t n = 0; n < all.size(); ++n) {
      const std::vector<double> expected = EstimatesAt(1, mesh, lattice, all[n]);
      for (const double scale : {0x1p-333, 0x1p-300, 0x1p250, 0x1p333}) {
        const std::vector<double> found = EstimatesAt(scale, mesh, lattice, all[n]);
        for (size_t m = 0; m < found.size(); ++m) {
          EXPECT_TRUE(std::abs(found[m] - expected[m]) <= 1e-9 * expected[m])
              << scale << ", options " << n << ", number " << m << ": " << found[m] << ", not " << expected[m];
        }
      }
    }
  }
}

}  // namespace
}  // namespace latvox
