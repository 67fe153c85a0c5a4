// The thesis's algorithms as jobs. They keep the promises of exact jobs, and are compared on the bunny.
#include "core/voxelizer/thesis_job.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "core/base/stop_signal.h"
#include "core/snap/mesh_range.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/thesis_meshes.h"

namespace latvox {
namespace {

constexpr Algorithm kThesis[] = {Algorithm::kBruteForce, Algorithm::kIncremental, Algorithm::kOptimizedIncremental};

TEST(Algorithm, NamesGoBothWays) {
  for (const auto& [algorithm, name] : kAlgorithms) {
    EXPECT_EQ(NameOf(algorithm), name);
    EXPECT_EQ(AlgorithmNamed(name), algorithm);
  }
  EXPECT_EQ(NameOf(Algorithm::kOptimizedIncremental), "optimized-incremental");
  EXPECT_EQ(AlgorithmNamed("Exact"), std::nullopt);
}

Grid GridFor(NamedLattice name, double voxel_size) {
  return {*Lattice::Named(name).Scaled(voxel_size), {-3.2, 1.5, 0.25}};
}

TEST(ThesisJob, DeliversTheWholeSetInCanonicalOrderOnceForAnyThreads) {
  const TriangleMesh mesh = RotatedTetrahedron(35, 1);
  for (NamedLattice name : {NamedLattice::kCartesian, NamedLattice::kBcc, NamedLattice::kFcc}) {
    const Grid grid = GridFor(name, 1.0 / 180);
    for (Algorithm algorithm : kThesis) {
      const VoxelSet expected = *VoxelizeByThesis(mesh, grid, 0, algorithm, StopSignal());
      std::optional<Digest> digest;
      for (int threads : {1, 3}) {
        const Result result = Voxelize(mesh, grid, {.algorithm = algorithm}, threads);
        VoxelSet delivered;
        uint64_t voxels = 0, bricks = 0;
        for (const TileBricks& tile : result.tiles) {
          for (const Brick& brick : tile.bricks) {
            delivered.Add(brick);
            for (size_t m = 0; m < 3; ++m) EXPECT_EQ(brick.brick_ijk[m] >> 3, tile.tile_ijk[m]);
          }
          voxels += tile.voxels;
          bricks += tile.bricks.size();
        }
        EXPECT_GT(result.tiles.size(), 8U);
        EXPECT_EQ(voxels, expected.size()) << NameOf(algorithm);
        EXPECT_EQ(result.totals.voxels, voxels);
        EXPECT_EQ(result.totals.bricks, bricks);
        const auto given = delivered.Bricks(), wanted = expected.Bricks();
        ASSERT_EQ(given.size(), wanted.size());
        for (size_t n = 0; n < given.size(); ++n) {
          ASSERT_EQ(given[n].brick_ijk, wanted[n].brick_ijk);
          ASSERT_EQ(given[n].mask, wanted[n].mask);
        }
        EXPECT_EQ(digest.value_or(result.totals.digest), result.totals.digest);
        digest = result.totals.digest;
      }
    }
  }
}

uint64_t Morton(const Vec3i& relative) {
  uint64_t code = 0;
  for (int bit = 20; bit >= 0; --bit) {
    for (int32_t x : relative) code = code << 1 | static_cast<uint64_t>(x >> bit & 1);
  }
  return code;
}

TEST(ThesisJob, KeepsToItsBoxAndToMortonOrderFromTheBoxsLowTile) {
  const TriangleMesh mesh = RotatedTetrahedron(35, 1);
  for (Algorithm algorithm : kThesis) {
    auto job = *VoxelizeJob::Create(mesh, GridFor(NamedLattice::kFcc, 1.0 / 180), {.algorithm = algorithm});
    const IndexBox box = *job->facts().index_box;
    Vec3i low;
    for (size_t m = 0; m < 3; ++m) low[m] = box.min[m] >> kTileBits;
    std::vector<TileBricks> tiles;
    ASSERT_TRUE(*job->Advance([&](TileBricks&& tile) {
      tiles.push_back(std::move(tile));
      return true;
    }));
    EXPECT_LE(tiles.size(), job->facts().tiles_in_box);
    for (size_t n = 0; n < tiles.size(); ++n) {
      if (n > 0) {
        EXPECT_LT(Morton(tiles[n - 1].tile_ijk - low), Morton(tiles[n].tile_ijk - low));
        EXPECT_LT(tiles[n - 1].progress, tiles[n].progress);
      }
      for (size_t b = 0; b < tiles[n].bricks.size(); ++b) {
        EXPECT_TRUE(b == 0 || tiles[n].bricks[b - 1].brick_ijk < tiles[n].bricks[b].brick_ijk);
        Brick brick = tiles[n].bricks[b];
        ClipBrick(box, brick);
        EXPECT_EQ(brick.mask, tiles[n].bricks[b].mask);
      }
    }
    EXPECT_EQ(tiles.back().progress, 1);
  }
}

TEST(ThesisJob, PausesResumesClipsAndCancels) {
  const TriangleMesh mesh = RotatedTetrahedron(35, 1);
  const Grid grid = GridFor(NamedLattice::kBcc, 1.0 / 150);
  for (Algorithm algorithm : kThesis) {
    const Result whole = Voxelize(mesh, grid, {.algorithm = algorithm});
    auto job = *VoxelizeJob::Create(mesh, grid, {.algorithm = algorithm});
    size_t tiles = 0, rounds = 0;
    for (bool done = false; !done; ++rounds) {
      done = *job->Advance([&](TileBricks&& tile) {
        EXPECT_EQ(tile.tile_ijk, whole.tiles[tiles].tile_ijk);
        return ++tiles % 4 != 0;
      });
    }
    EXPECT_EQ(tiles, whole.tiles.size());
    EXPECT_GT(rounds, 3U);
    EXPECT_EQ(job->totals().digest, whole.totals.digest);

    std::set<oracle::Int3> joined;
    const IndexBox box = *job->facts().index_box;
    IndexBox left = box, right = box;
    left.max[0] = right.min[0] = (box.min[0] + box.max[0]) / 2;
    for (const IndexBox& region : {left, right}) {
      const auto part = VoxelsOf(Voxelize(mesh, grid, {.region = region, .algorithm = algorithm}));
      for (const auto& z : part) {
        EXPECT_TRUE(region.min[0] <= z[0] && z[0] < region.max[0]);
        EXPECT_TRUE(joined.insert(z).second);
      }
    }
    EXPECT_EQ(joined, VoxelsOf(whole));
    const Result nothing =
        Voxelize(mesh, grid, {.region = IndexBox{{1000000, 0, 0}, {1000001, 1, 1}}, .algorithm = algorithm});
    EXPECT_TRUE(nothing.tiles.empty());

    auto cancelled = *VoxelizeJob::Create(mesh, grid, {.algorithm = algorithm});
    cancelled->Cancel();
    EXPECT_EQ(cancelled->Advance([](TileBricks&&) { return true; }).status().code(), absl::StatusCode::kCancelled);
    auto late = *VoxelizeJob::Create(mesh, grid, {.algorithm = algorithm});
    int after = 0;
    EXPECT_EQ(late->Advance([&](TileBricks&&) {
                    ++after;
                    late->Cancel();
                    return true;
                  })
                  .status()
                  .code(),
              absl::StatusCode::kCancelled);
    EXPECT_EQ(after, 1);
  }
}

TEST(ThesisJob, CancelEndsALongComputationFromAnotherThread) {
  const TriangleMesh mesh = RotatedTetrahedron(35, 1);
  for (Algorithm algorithm : kThesis) {
    auto job = *VoxelizeJob::Create(mesh, GridFor(NamedLattice::kCartesian, 1.0 / 30000), {.algorithm = algorithm});
    std::thread other([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(30));
      job->Cancel();
    });
    const auto done = job->Advance([](TileBricks&&) { return true; });
    other.join();
    EXPECT_EQ(done.status().code(), absl::StatusCode::kCancelled);
  }
}

TEST(ThesisJob, BunnyByEveryAlgorithm) {
  const auto bunny = ReadObj(kBunny);
  ASSERT_TRUE(bunny) << "no " << kBunny << ": install the package glmark2-data";
  const char* resolution = std::getenv("LATVOX_TEST_RESOLUTION");
  const auto d = static_cast<uint32_t>(resolution != nullptr ? std::atoi(resolution) : 64);
  for (NamedLattice name :
       {NamedLattice::kCartesian, NamedLattice::kBcc, NamedLattice::kFcc, NamedLattice::kHexagonal}) {
    for (int k : {0, 1, 2}) {
      const Lattice lattice = Lattice::Named(name);
      if (k > 0 && lattice.frames(k).size() == lattice.frames(k - 1).size()) continue;
      const Grid grid = *ResolveGrid(lattice, {.resolution = d}, std::nullopt, BoundsOf(*bunny));
      for (const auto& [algorithm, algorithm_name] : kAlgorithms) {
        auto job = *VoxelizeJob::Create(*bunny, grid, {.separability = k, .algorithm = algorithm});
        VoxelSet voxels;
        const auto start = std::chrono::steady_clock::now();
        ASSERT_TRUE(*job->Advance([&](TileBricks&& tile) {
          for (const Brick& brick : tile.bricks) voxels.Add(brick);
          return true;
        }));
        const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
        const Verdict verdict = *job->Verify(voxels);
        EXPECT_EQ(voxels.size(), job->totals().voxels);
        if (algorithm == Algorithm::kExact) {
          EXPECT_EQ(verdict.tunnels, 0U);
          EXPECT_EQ(verdict.redundant, 0U);
        }
        EXPECT_TRUE(algorithm != Algorithm::kBruteForce || verdict.tunnels == 0);
        // Against the surface that the incremental algorithms voxelize.
        const SnappedMesh snapped = *Snap(*bunny, grid.lattice, grid.origin, {2, 2, 2});
        const Verdict rounded =
            *CountTunnels(Rounded(snapped, grid.lattice), grid.lattice.frames(k), voxels, StopSignal());
        EXPECT_TRUE(algorithm != Algorithm::kIncremental || rounded.tunnels == 0);
        std::printf(
            "%-10s k %d %-21s %7zu voxels %6zu tunnels %6zu redundant; rounded: %6zu tunnels %6zu redundant; %.0f ms\n",
            std::string(lattice.name()).c_str(), k, std::string(algorithm_name).c_str(),
            static_cast<size_t>(voxels.size()), static_cast<size_t>(verdict.tunnels),
            static_cast<size_t>(verdict.redundant), static_cast<size_t>(rounded.tunnels),
            static_cast<size_t>(rounded.redundant), took.count());
      }
    }
  }
}

}  // namespace
}  // namespace latvox
