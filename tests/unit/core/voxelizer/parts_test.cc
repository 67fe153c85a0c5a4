// The parts of the whole that a job delivers: regions, the rest after a tile, and shards.
#include <gtest/gtest.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <random>
#include <set>

#include "core/base/stop_signal.h"
#include "core/block/tile_job.h"
#include "core/brick/tile_order.h"
#include "core/snap/snap.h"
#include "core/voxelizer/shard.h"
#include "core/voxelizer/voxelizer.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/sphere.h"
#include "tests/unit/dose.h"

namespace latvox {
namespace {

TEST(Regions, ArePartsOfTheWholeAndTheirDigestsAddUpOnBrickBorders) {
  const TriangleMesh mesh = Sphere(20, 60);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kBcc));
  const auto whole = VoxelsOf(Voxelize(mesh, grid, {}));
  std::set<oracle::Int3> joined;
  size_t count = 0;
  for (const IndexBox& region : {IndexBox{{-500, -500, -500}, {3, 500, 500}}, IndexBox{{3, -500, -500}, {500, -7, 500}},
                                 IndexBox{{3, -7, -500}, {500, 500, 500}}}) {
    const auto part = VoxelsOf(Voxelize(mesh, grid, {.region = region}));
    count += part.size();
    joined.insert(part.begin(), part.end());
    for (const auto& z : part) {
      EXPECT_TRUE(
          region.Contains({static_cast<int32_t>(z[0]), static_cast<int32_t>(z[1]), static_cast<int32_t>(z[2])}));
    }
  }
  EXPECT_EQ(count, whole.size());
  EXPECT_EQ(joined, whole);

  Digest sum;
  for (const IndexBox& region :
       {IndexBox{{-512, -512, -512}, {8, 512, 512}}, IndexBox{{8, -512, -512}, {512, 512, 512}}}) {
    sum.Add(Voxelize(mesh, grid, {.region = region}).totals.digest);
  }
  EXPECT_EQ(sum, Voxelize(mesh, grid, {}).totals.digest);
}

// The rest after each tile is the stream's end: alone or with the region of the first, on one thread and on three.
TEST(Resume, GoesOnAfterAnyTileExactly) {
  const TriangleMesh mesh = Sphere(30, 170);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kBcc));
  for (const auto& region : {std::optional<IndexBox>(), std::optional(IndexBox{{-90, -70, -200}, {150, 90, 40}})}) {
    for (const Algorithm algorithm : {Algorithm::kExact, Algorithm::kIncremental}) {
      const Result whole = Voxelize(mesh, grid, {.region = region, .algorithm = algorithm});
      ASSERT_GT(whole.tiles.size(), 12U);
      Digest delivered;
      for (size_t n = 0; n < whole.tiles.size(); ++n) {
        for (const Brick& brick : whole.tiles[n].bricks) delivered.Add(brick);
        const size_t step = algorithm == Algorithm::kExact ? Dose(1, 16) : Dose(8, 32);  // thesis: computes the whole
        if (n % step != step / 2) continue;
        const Vec3i& tile = whole.tiles[n].tile_ijk;
        const Result rest =
            Voxelize(mesh, grid, {.region = region, .algorithm = algorithm, .resume_after = tile}, n % 2 == 0 ? 1 : 3);
        ASSERT_EQ(rest.tiles.size(), whole.tiles.size() - n - 1);
        EXPECT_EQ(rest.totals.tiles, rest.tiles.size());
        for (size_t r = 0; r < rest.tiles.size(); ++r)
          EXPECT_EQ(rest.tiles[r].tile_ijk, whole.tiles[n + 1 + r].tile_ijk);
        Digest sum = delivered;
        sum.Add(rest.totals.digest);
        EXPECT_EQ(sum, whole.totals.digest);
      }
    }
  }
}

TEST(Resume, GoesOnAfterATileWithoutVoxels) {
  const TriangleMesh mesh = Sphere(30, 170);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  const Result whole = Voxelize(mesh, grid, {});
  const auto last = std::find_if(whole.tiles.begin(), whole.tiles.end(), [](const TileBricks& tile) {
    return Morton(tile.tile_ijk - Vec3i{-3, -3, -3}) > Morton(Vec3i{2, 2, 2});
  });
  const Result rest = Voxelize(mesh, grid, {.resume_after = Vec3i{-1, -1, -1}});  // in the sphere's hollow
  ASSERT_EQ(rest.tiles.size(), static_cast<size_t>(whole.tiles.end() - last));
  EXPECT_EQ(rest.tiles.front().tile_ijk, last->tile_ijk);
}

TEST(Resume, RefusesToGoOnAfterATileOutsideOfTheIndexBox) {
  const TriangleMesh mesh = Sphere(10, 20);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  for (const Vec3i& tile : {Vec3i{1, 0, 0}, Vec3i{0, -2, 0}, Vec3i{INT32_MAX, INT32_MIN, 0}}) {
    const auto job = VoxelizeJob::Create(mesh, grid, {.resume_after = tile});
    ASSERT_FALSE(job.ok());
    EXPECT_EQ(job.status().message().substr(0, 19), "resume_after: tile ");
  }
  EXPECT_FALSE(
      VoxelizeJob::Create(mesh, grid, {.region = IndexBox{{1000, 0, 0}, {1001, 1, 1}}, .resume_after = Vec3i{0, 0, 0}})
          .ok());
}

TEST(Regions, WithoutSurfaceAreEmptyNotAnError) {
  const Result result = Voxelize(Sphere(10, 20), Unscaled(Lattice::Named(NamedLattice::kCartesian)),
                                 {.region = IndexBox{{1000000, 0, 0}, {1000001, 1, 1}}});
  EXPECT_TRUE(result.tiles.empty());
  EXPECT_EQ(result.totals.digest.ToHex(), std::string(32, '0'));
}

struct Case {
  const char* name;
  TriangleMesh mesh;
  Grid grid;
  VoxelizeOptions options;
};

std::vector<Case> Cases() {
  const auto lattice = [](NamedLattice name) { return Unscaled(Lattice::Named(name)); };
  TriangleMesh box = Sphere(2, 200);  // few and large triangles
  TriangleMesh flat;                  // no voxel
  flat.vertices = {{0, 0, 0}, {300, 300, 300}, {100, 100, 100}};
  flat.triangles = {{0, 1, 2}};
  return {
      {"sphere", Sphere(30, 170), lattice(NamedLattice::kBcc), {}},
      {"box", box, lattice(NamedLattice::kFcc), {.separability = 2}},
      {"flat", flat, lattice(NamedLattice::kCartesian), {}},
      {"region",
       Sphere(30, 170),
       lattice(NamedLattice::kCartesian),
       {.region = IndexBox{{-90, -70, -200}, {150, 90, 40}}}},
      {"far region",
       Sphere(30, 170),
       lattice(NamedLattice::kCartesian),
       {.region = IndexBox{{1000, 0, 0}, {1001, 1, 1}}}},
      {"thesis", Sphere(30, 170), lattice(NamedLattice::kHexagonal), {.algorithm = Algorithm::kIncremental}},
  };
}

TEST(Shards, FollowEachOtherAndMakeTheWhole) {
  for (const Case& c : Cases()) {
    const Result whole = Voxelize(c.mesh, c.grid, c.options);
    for (const uint32_t count : Dose<std::vector<uint32_t>>({1, 2, 7, 64}, {7, 16})) {
      if (count > 7 && c.options.algorithm != Algorithm::kExact) continue;  // each part computes the whole
      Digest sum;
      std::vector<Vec3i> tiles;
      uint64_t voxels = 0;
      for (uint32_t index = 0; index < count; ++index) {
        VoxelizeOptions options = c.options;
        options.shard = Shard{index, count};
        const Result part = Voxelize(c.mesh, c.grid, options, index % 2 == 0 ? 1 : 3);
        sum.Add(part.totals.digest);
        voxels += part.totals.voxels;
        double progress = 0;
        for (const TileBricks& tile : part.tiles) {
          tiles.push_back(tile.tile_ijk);
          EXPECT_GE(tile.progress, progress) << c.name;
          EXPECT_LE(tile.progress, 1) << c.name;
          progress = tile.progress;
        }
      }
      EXPECT_EQ(sum, whole.totals.digest) << c.name << ' ' << count;
      EXPECT_EQ(voxels, whole.totals.voxels) << c.name << ' ' << count;
      ASSERT_EQ(tiles.size(), whole.tiles.size()) << c.name << ' ' << count;
      for (size_t n = 0; n < tiles.size(); ++n) EXPECT_EQ(tiles[n], whole.tiles[n].tile_ijk) << c.name << ' ' << count;
    }
  }
}

TEST(Shards, ResumeLikeTheWhole) {
  const TriangleMesh mesh = Sphere(30, 170);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  const Result part = Voxelize(mesh, grid, {.shard = Shard{1, 3}});
  ASSERT_GT(part.tiles.size(), 4U);
  for (size_t n = 0; n < part.tiles.size(); ++n) {
    const Result rest = Voxelize(mesh, grid, {.shard = Shard{1, 3}, .resume_after = part.tiles[n].tile_ijk});
    ASSERT_EQ(rest.tiles.size(), part.tiles.size() - n - 1);
    for (size_t r = 0; r < rest.tiles.size(); ++r) EXPECT_EQ(rest.tiles[r].tile_ijk, part.tiles[n + 1 + r].tile_ijk);
  }
}

// Lattices of up to 2^11 tiles a side, where shards are made of octants of several tiles.
TEST(Shards, CostAboutTheSame) {
  const Lattice cartesian = Lattice::Named(NamedLattice::kCartesian);
  for (const auto& [name, mesh, least] :
       {std::tuple("sphere", Sphere(100, 1500), 800U), std::tuple("large triangles", Sphere(3, 1500), 800U)}) {
    const Grid grid = Unscaled(cartesian);
    for (const uint32_t count : Dose<std::vector<uint32_t>>({2, 7, 64}, {3})) {
      uint64_t most = 0, all = 0;
      for (uint32_t index = 0; index < count; ++index) {
        const uint64_t voxels = Voxelize(mesh, grid, {.separability = 2, .shard = Shard{index, count}}).totals.voxels;
        most = std::max(most, voxels);
        all += voxels;
      }
      EXPECT_GT(all, least * 1000) << name;
      EXPECT_LT(static_cast<double>(most), 1.25 * static_cast<double>(all) / count) << name << ' ' << count;
    }
  }
}

// Spans alone, of more tiles than are computed in a test.
TEST(Shards, SpansFollowEachOtherInHugeLattices) {
  const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  const std::vector<Frame>& frames = lattice.frames(0);
  for (const float radius : {10.0F, 4000.0F, 32000.0F}) {
    const SnappedMesh mesh = *Snap(Sphere(20, radius), lattice, {0, 0, 0}, ReachOf(frames));
    const auto span_of = [&](uint32_t index, uint32_t count) {
      return SpanOf({.shard = Shard{index, count}}, mesh, frames, mesh.box, std::nullopt, StopSignal());
    };
    for (const uint32_t count : Dose<std::vector<uint32_t>>({3, 1000, kMaxShards}, {1000})) {
      EXPECT_EQ(span_of(0, count).begin, 0U);
      EXPECT_EQ(span_of(count - 1, count).end, TileSpan{}.end);
      for (const uint32_t index : {0U, count / 3, count / 2, count - 2}) {
        const TileSpan span = span_of(index, count);
        EXPECT_LE(span.begin, span.end);
        EXPECT_EQ(span.end, span_of(index + 1, count).begin);
      }
    }
  }
}

// Nothing of it is delivered, so the job only divides the tree of tiles.
TEST(Parts, CountTheTimeOfTheSearchForThemOnAllThreads) {
  const TriangleMesh mesh = Sphere(200, 400);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  const auto seconds = [&](int threads) {
    double sum = 0;
    for (int repeat = 0; repeat < 8; ++repeat) {
      const auto job = VoxelizeJob::Create(mesh, grid, {.region = IndexBox{{0, 0, 0}, {2, 2, 2}}});
      EXPECT_TRUE(job.ok()) << job.status();
      const double before = (*job)->CpuSeconds();
      oneapi::tbb::task_arena arena(threads);
      arena.execute([&] {
        const auto done = (*job)->Advance([](TileBricks&&) { return true; });
        EXPECT_TRUE(done.ok() && *done);
      });
      EXPECT_EQ((*job)->totals().tiles, 0U);
      sum += (*job)->CpuSeconds() - before;
    }
    return sum;
  };
  EXPECT_GE(seconds(4), 0.8 * seconds(1));
}

TEST(Shards, AreRefusedOutOfRange) {
  const TriangleMesh mesh = Sphere(4, 20);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  for (const Shard& shard : {Shard{0, 0}, Shard{1, 1}, Shard{7, 3}, Shard{0, kMaxShards + 1}}) {
    const auto job = VoxelizeJob::Create(mesh, grid, {.shard = shard});
    ASSERT_FALSE(job.ok());
    EXPECT_EQ(job.status().message().substr(0, 6), "shard.");
  }
}

TEST(TileNumber, IsTheBitsOfAllAxesInTurn) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int32_t> coordinate(0, (1 << 21) - 1);
  for (int n = 0; n < 1000; ++n) {
    const Vec3i tile = {coordinate(random), coordinate(random), coordinate(random)};
    ASSERT_EQ(TileNumber(tile), Morton(tile));
  }
  EXPECT_EQ(TileNumber({0, 0, 0}), 0U);
  EXPECT_EQ(TileNumber({(1 << 21) - 1, (1 << 21) - 1, (1 << 21) - 1}), (uint64_t{1} << 63) - 1);
}

}  // namespace
}  // namespace latvox
