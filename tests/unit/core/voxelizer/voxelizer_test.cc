// The pipeline's promises about covers, order, threads, parts and cancellation.
#include "core/voxelizer/voxelizer.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/task_arena.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <utility>

#include "core/base/stop_signal.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/sphere.h"
#include "tests/unit/dose.h"

namespace latvox {
namespace {

TEST(Pipeline, CoversEveryCrossedLinkAndKeepsNoRedundantVoxelOnSoups) {
  constexpr unsigned kSeed = 99;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> coordinate(0, 80);
  TriangleMesh soup;
  for (uint32_t n = 0; n < 240; ++n) {
    soup.vertices.push_back({coordinate(random), coordinate(random), coordinate(random)});
    if (n % 3 == 2) soup.triangles.push_back({n - 2, n - 1, n});
  }
  for (const ExactLattice& l : ExactLattices()) {
    for (int k : {0, 2}) {
      auto job = *VoxelizeJob::Create(soup, Unscaled(l.lattice), {.separability = k});
      VoxelSet voxels;
      ASSERT_TRUE(job->Advance([&](TileBricks&& tile) {
                       for (const Brick& brick : tile.bricks) voxels.Add(brick);
                       return true;
                     })
                      .ok());
      const auto verdict = job->Verify(voxels);
      ASSERT_TRUE(verdict.ok());
      EXPECT_EQ(verdict->tunnels, 0U) << l.name << " seed " << kSeed;
      EXPECT_EQ(verdict->redundant, 0U) << l.name << " seed " << kSeed;
      EXPECT_EQ(voxels.size(), job->totals().voxels);
    }
  }
}

// Some 100,000 triangles in few tiles, with sides of a quarter or half of a voxel. Most are left out before the scan,
// or are tiny.
TEST(Pipeline, MeshesMuchFinerThanTheLatticeAreCoveredAndMinimalOnEachKernel) {
  const Grid grid = Unscaled(ExactLattices().front().lattice);
  for (const float radius : {14.0F, 26.0F}) {
    const TriangleMesh sphere = Sphere(160, radius);
    std::string digest;
    for (const Simd simd : SimdHere()) {
      const ForcedSimd forced(simd);
      auto job = *VoxelizeJob::Create(sphere, grid, {});
      VoxelSet voxels;
      ASSERT_TRUE(job->Advance([&](TileBricks&& tile) {
                       for (const Brick& brick : tile.bricks) voxels.Add(brick);
                       return true;
                     })
                      .ok());
      if (digest.empty()) digest = job->totals().digest.ToHex();
      EXPECT_EQ(job->totals().digest.ToHex(), digest) << SimdInUse();
      const auto verdict = job->Verify(voxels);
      ASSERT_TRUE(verdict.ok());
      EXPECT_EQ(verdict->tunnels, 0U);
      EXPECT_EQ(verdict->redundant, 0U);
    }
  }
}

TEST(Verify, CountsTunnelsAndRedundantVoxelsOfADamagedSet) {
  const Grid grid = Unscaled(ExactLattices()[0].lattice);
  auto job = *VoxelizeJob::Create(Sphere(12, 20), grid, {.separability = 2});
  std::vector<Brick> bricks;
  ASSERT_TRUE(job->Advance([&](TileBricks&& tile) {
                   bricks.insert(bricks.end(), tile.bricks.begin(), tile.bricks.end());
                   return true;
                 })
                  .ok());
  VoxelSet damaged;
  Brick first = bricks[0];
  for (uint64_t& word : first.mask) {
    if (word != 0) {
      word &= word - 1;  // one voxel less
      break;
    }
  }
  damaged.Add(first);
  for (size_t n = 1; n < bricks.size(); ++n) damaged.Add(bricks[n]);
  EXPECT_GT(job->Verify(damaged)->tunnels, 0U);
  VoxelSet padded;
  for (const Brick& brick : bricks) padded.Add(brick);
  padded.Add({{100, 100, 100}, {7}});  // three voxels far from the surface
  EXPECT_EQ(job->Verify(padded)->redundant, 3U);
  EXPECT_EQ(job->Verify(padded)->tunnels, 0U);
}

TEST(Pipeline, GivesTheSameTilesForAnyThreadsAndTriangleOrder) {
  TriangleMesh mesh = Sphere(40, 150);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kBcc));
  const Result one = Voxelize(mesh, grid, {}, 1);
  EXPECT_GT(one.tiles.size(), 50U);
  constexpr unsigned kSeed = 5;
  std::mt19937 random(kSeed);
  for (int threads : {1, 2, 5}) {
    std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
    for (auto& t : mesh.triangles) std::rotate(t.begin(), t.begin() + random() % 3, t.end());
    const Result other = Voxelize(mesh, grid, {}, threads);
    EXPECT_EQ(other.totals.digest, one.totals.digest) << threads << " threads, seed " << kSeed;
    ASSERT_EQ(other.tiles.size(), one.tiles.size());
    for (size_t n = 0; n < one.tiles.size(); ++n) ASSERT_EQ(other.tiles[n].tile_ijk, one.tiles[n].tile_ijk);
  }
}

TEST(Pipeline, DeliversTilesInMortonOrderBricksInLexicographicOrderAndProgressRising) {
  const TriangleMesh mesh = Sphere(30, 170);
  auto job = *VoxelizeJob::Create(mesh, Unscaled(Lattice::Named(NamedLattice::kCartesian)), {});
  const IndexBox box = *job->facts().index_box;
  Vec3i low;
  for (size_t m = 0; m < 3; ++m) low[m] = box.min[m] >> kTileBits;
  std::vector<TileBricks> tiles;
  ASSERT_TRUE(job->Advance([&](TileBricks&& tile) {
                   tiles.push_back(std::move(tile));
                   return true;
                 })
                  .ok());
  EXPECT_LE(tiles.size(), job->facts().tiles_in_box);
  EXPECT_EQ(tiles.size(), job->totals().tiles);
  for (size_t n = 0; n < tiles.size(); ++n) {
    if (n > 0) {
      EXPECT_LT(Morton(tiles[n - 1].tile_ijk - low), Morton(tiles[n].tile_ijk - low));
      EXPECT_LE(tiles[n - 1].progress, tiles[n].progress);
    }
    uint64_t voxels = 0;
    for (size_t b = 0; b < tiles[n].bricks.size(); ++b) {
      const Brick& brick = tiles[n].bricks[b];
      EXPECT_GT(CountVoxels(brick.mask), 0U);
      voxels += CountVoxels(brick.mask);
      for (size_t m = 0; m < 3; ++m) {
        EXPECT_EQ(brick.brick_ijk[m] >> 3, tiles[n].tile_ijk[m]);
        EXPECT_GE(brick.brick_ijk[m] * 8 + 7, box.min[m]);
        EXPECT_LT(brick.brick_ijk[m] * 8, box.max[m]);
      }
      EXPECT_TRUE(b == 0 || tiles[n].bricks[b - 1].brick_ijk < brick.brick_ijk);
    }
    EXPECT_EQ(voxels, tiles[n].voxels);
  }
  EXPECT_GT(tiles.back().progress, 0.5);
  EXPECT_LE(tiles.back().progress, 1);
}

TEST(Pipeline, PausesAndGoesOnWithoutLosingOrRepeatingATile) {
  const TriangleMesh mesh = Sphere(30, 170);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kFcc));
  const Result whole = Voxelize(mesh, grid, {});
  auto job = *VoxelizeJob::Create(mesh, grid, {});
  oneapi::tbb::task_arena one_thread(1);  // more would finish more tiles after each pause
  size_t tiles = 0, rounds = 0;
  while (true) {
    const auto done = one_thread.execute([&] {
      return job->Advance([&](TileBricks&& tile) {
        EXPECT_EQ(tile.tile_ijk, whole.tiles[tiles].tile_ijk);
        ++tiles;
        return false;
      });
    });
    ASSERT_TRUE(done.ok());
    ++rounds;
    if (*done) break;
  }
  EXPECT_EQ(tiles, whole.tiles.size());
  EXPECT_GT(rounds, 3U);
  EXPECT_EQ(job->totals().digest, whole.totals.digest);
}

// Triangles across a whole tile: more candidates than one part holds.
TEST(Pipeline, TanglesOfLargeTrianglesAreCoveredAndMinimal) {
  constexpr unsigned kSeed = 7;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> coordinate(0, 62);
  TriangleMesh tangle;
  for (uint32_t n = 0; n < Dose(4500U, 1500U); ++n) {
    Vec3f corner = {coordinate(random), coordinate(random), coordinate(random)};
    corner[n % 3] = n % 2 == 0 ? 0 : 62;
    tangle.vertices.push_back(corner);
    if (n % 3 == 2) tangle.triangles.push_back({n - 2, n - 1, n});
  }
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  auto job = *VoxelizeJob::Create(tangle, grid, {});
  VoxelSet voxels;
  ASSERT_TRUE(job->Advance([&](TileBricks&& tile) {
                   for (const Brick& brick : tile.bricks) voxels.Add(brick);
                   return true;
                 })
                  .ok());
  const auto verdict = job->Verify(voxels);
  ASSERT_TRUE(verdict.ok());
  EXPECT_EQ(verdict->tunnels, 0U) << "seed " << kSeed;
  EXPECT_EQ(verdict->redundant, 0U) << "seed " << kSeed;
}

TEST(Pipeline, CancelEndsAdvanceFromAnotherThreadAndFromTheSink) {
  const TriangleMesh mesh = Sphere(40, 3000);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  auto job = *VoxelizeJob::Create(mesh, grid, {});
  std::atomic<int> tiles = 0;
  std::thread other([&] {
    while (tiles < 3) std::this_thread::yield();
    job->Cancel();
  });
  const auto done = job->Advance([&](TileBricks&&) {
    ++tiles;
    return true;
  });
  other.join();
  EXPECT_EQ(done.status().code(), absl::StatusCode::kCancelled);
  EXPECT_EQ(job->Advance([](TileBricks&&) { return true; }).status().code(), absl::StatusCode::kCancelled);

  auto second = *VoxelizeJob::Create(mesh, grid, {});
  int after = 0;
  EXPECT_EQ(second
                ->Advance([&](TileBricks&&) {
                  ++after;
                  second->Cancel();
                  return true;
                })
                .status()
                .code(),
            absl::StatusCode::kCancelled);
  EXPECT_EQ(after, 1);
}

TEST(VoxelizeJob, CreateIsCancelledAtOnceAndMidway) {
  const TriangleMesh mesh = Sphere(400, 100);  // 640,000 triangles
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  StopSource stopped;
  stopped.Stop();
  EXPECT_EQ(VoxelizeJob::Create(mesh, grid, {}, stopped.Signal()).status().code(), absl::StatusCode::kCancelled);
  // Invalid parts have not been checked by then.
  const TriangleMesh no_vertices{.vertices = {}, .triangles = {{0, 0, 0}}};
  EXPECT_EQ(VoxelizeJob::Create(no_vertices, grid, {}, stopped.Signal()).status().code(), absl::StatusCode::kCancelled);
  EXPECT_EQ(VoxelizeJob::Create(mesh, grid, {.algorithm = Algorithm::kIncremental}, stopped.Signal()).status().code(),
            absl::StatusCode::kCancelled);
  for (int n = 0; n < 20; ++n) {
    StopSource source;
    std::thread canceller([&source, n] {
      std::this_thread::sleep_for(std::chrono::microseconds(300 * n));
      source.Stop();
    });
    const auto job = VoxelizeJob::Create(mesh, grid, {}, source.Signal());
    canceller.join();
    EXPECT_TRUE(job.ok() || job.status().code() == absl::StatusCode::kCancelled);
  }
}

TEST(VoxelizeJob, SharesAMeshWithOthersAndOutlivesThem) {
  const Grid grid = Unscaled(ExactLattices().front().lattice);
  for (const uint32_t attributes : {0U, 1U}) {
    const VoxelRequest request{.fields = attributes ? FieldList{Field::kPart} : FieldList{}};
    TriangleMesh own = Sphere(20, 60);
    for (uint32_t n = 0; n < own.vertices.size() * attributes; ++n) own.attributes.push_back(n);
    auto shared = std::make_shared<const TriangleMesh>(own);
    const std::weak_ptr<const TriangleMesh> left = shared;
    auto first = *VoxelizeJob::CreateFromValid(shared, grid, request);
    auto second = *VoxelizeJob::CreateFromValid(std::move(shared), grid, request);
    const auto all = [](TileBricks&&) { return true; };
    const auto carried_by = [](const VoxelizeJob& job) {
      return job.totals().fields.empty() ? "" : job.totals().fields[0].ToHex();
    };
    ASSERT_TRUE(first->Advance(all).ok());
    EXPECT_EQ(left.lock()->triangles, own.triangles);
    EXPECT_EQ(left.lock()->attributes, own.attributes);
    const std::string digest = first->totals().digest.ToHex(), carried = carried_by(*first);
    first.reset();
    ASSERT_TRUE(second->Advance(all).ok());
    EXPECT_EQ(second->totals().digest.ToHex(), digest);
    EXPECT_EQ(carried_by(*second), carried);
    second.reset();
    EXPECT_TRUE(left.expired());
    auto alone = *VoxelizeJob::CreateFromValid(own, grid, request);
    ASSERT_TRUE(alone->Advance(all).ok());
    EXPECT_EQ(alone->totals().digest.ToHex(), digest);
    EXPECT_EQ(carried_by(*alone), carried);
  }
}

TEST(Pipeline, HugeLatticeCostsWhatTheRegionCosts) {
  // 20 triangles over 65,536 voxels: a small region must not walk the whole.
  const TriangleMesh mesh = Sphere(3, 30000);
  const Vec3f& corner = mesh.vertices[1];
  Vec3i low, high;
  for (size_t m = 0; m < 3; ++m) {
    low[m] = static_cast<int32_t>(corner[m]) - 300;
    high[m] = low[m] + 600;
  }
  const IndexBox region{low, high};
  const Result result =
      Voxelize(mesh, Unscaled(Lattice::Named(NamedLattice::kCartesian)), {.separability = 2, .region = region});
  EXPECT_GT(result.tiles.size(), 50U);
  EXPECT_LE(result.tiles.size(), 1331U);
}

// Large triangles, which Verify scans once for each place, and small ones.
TEST(Verify, CountsTrianglesAtOnePlaceOnce) {
  for (const ExactLattice& l : ExactLattices()) {
    TriangleMesh mesh = Sphere(4, 40);
    const TriangleMesh once = mesh;
    for (const auto& [a, b, c] : once.triangles) {
      for (const auto& triangle : {std::array{b, c, a}, {c, b, a}, {a, b, c}}) mesh.triangles.push_back(triangle);
    }
    const auto verdict = [&](const TriangleMesh& of) {
      auto job = *VoxelizeJob::Create(of, Unscaled(l.lattice), {});
      VoxelSet damaged;
      EXPECT_TRUE(job->Advance([&](TileBricks&& tile) {
                       for (size_t n = 0; n < tile.bricks.size(); n += 2) damaged.Add(tile.bricks[n]);
                       return true;
                     })
                      .ok());
      damaged.Add({{100, 100, 100}, {7}});
      return *job->Verify(damaged);
    };
    const Verdict expected = verdict(once), counted = verdict(mesh);
    EXPECT_GT(expected.tunnels, 100U) << l.name;
    EXPECT_GE(expected.redundant, 3U) << l.name;
    EXPECT_EQ(counted.tunnels, expected.tunnels) << l.name;
    EXPECT_EQ(counted.redundant, expected.redundant) << l.name;
  }
}

TEST(ResolveGrid, MapsTheLongestSideToOneVoxelLessThanTheResolution) {
  const Bounds bounds{{-1, 0, 2}, {1, 8, 3}};
  for (NamedLattice name : {NamedLattice::kCartesian, NamedLattice::kBcc, NamedLattice::kHexagonal}) {
    const auto grid = ResolveGrid(Lattice::Named(name), {.resolution = 17}, std::nullopt, bounds);
    ASSERT_TRUE(grid.ok());
    EXPECT_NEAR(grid->lattice.voxel_size(), 0.5, 1e-12);
    EXPECT_EQ(grid->origin, bounds.min);
  }
}

TEST(ResolveGrid, PlacesCellsHalfAVoxelSizeInside) {
  const Bounds bounds{{-1, 0, 2}, {1, 8, 3}};
  for (NamedLattice name : {NamedLattice::kCartesian, NamedLattice::kBcc, NamedLattice::kHexagonal}) {
    const Lattice lattice = Lattice::Named(name);
    const auto grid = ResolveGrid(lattice, {.resolution = 16}, std::nullopt, bounds, Placement::kCells);
    ASSERT_TRUE(grid.ok());
    EXPECT_NEAR(grid->lattice.voxel_size(), 0.5, 1e-12);
    for (size_t m = 0; m < 3; ++m) EXPECT_NEAR(grid->origin[m], bounds.min[m] + 0.25, 1e-12);
    const auto sized = ResolveGrid(lattice, {.voxel_size = 0.125}, std::nullopt, bounds, Placement::kCells);
    for (size_t m = 0; m < 3; ++m) EXPECT_NEAR(sized->origin[m], bounds.min[m] + 0.0625, 1e-12);
    const auto given = ResolveGrid(lattice, {.resolution = 16}, Vec3d{7, 8, 9}, bounds, Placement::kCells);
    EXPECT_EQ(given->origin, (Vec3d{7, 8, 9}));
  }
}

TEST(Placement, IsCellsForASolidUnlessGiven) {
  EXPECT_EQ(PlacementFor(Placement::kBySet, true), Placement::kCells);
  EXPECT_EQ(PlacementFor(Placement::kBySet, false), Placement::kPoints);
  for (const Placement asked : {Placement::kPoints, Placement::kCells}) {
    EXPECT_EQ(PlacementFor(asked, true), asked);
    EXPECT_EQ(PlacementFor(asked, false), asked);
  }
}

TEST(ResolveGrid, RefusesWhatIsOutOfRangeByName) {
  const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  const Bounds bounds{{0, 0, 0}, {1, 1, 1}}, point{{1, 1, 1}, {1, 1, 1}};
  const auto message = [&](const Sampling& sampling, std::optional<Vec3d> origin, const Bounds& b) {
    return std::string(ResolveGrid(lattice, sampling, origin, b).status().message());
  };
  EXPECT_EQ(message({.resolution = 0}, {}, bounds), "resolution 0 is below 2");
  EXPECT_EQ(message({.resolution = 70000}, {}, bounds), "resolution 70000 exceeds 65536");
  EXPECT_EQ(message({.voxel_size = 0}, {}, bounds), "voxel_size 0 is not a finite number above 0");
  EXPECT_EQ(message({.voxel_size = NAN}, {}, bounds), "voxel_size nan is not a finite number above 0");
  EXPECT_EQ(message({.voxel_size = 1}, Vec3d{0, INFINITY, 0}, bounds), "origin.y inf is not finite");
  EXPECT_EQ(message({.resolution = 5}, {}, point), "resolution: the mesh is a single point; give voxel_size");
  EXPECT_EQ(message({.voxel_size = 1, .resolution = 5}, {}, bounds), "resolution: not together with voxel_size");
}

TEST(VoxelizeJob, RefusesBadOptionsByName) {
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  const TriangleMesh mesh = Sphere(5, 5);
  EXPECT_EQ(VoxelizeJob::Create(mesh, grid, {.separability = 3}).status().message(), "separability 3 exceeds 2");
  EXPECT_EQ(VoxelizeJob::Create(mesh, grid, {.region = IndexBox{{0, 0, 0}, {1, 0, 1}}}).status().message(),
            "region.max.j 0 is not above region.min's 0");
}

}  // namespace
}  // namespace latvox
