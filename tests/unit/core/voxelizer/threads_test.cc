// Every kind of job gives the same result on several threads, and ends once cancelled. Meshes are large enough that
// each parallel loop has several parts. So the thread sanitizer sees all of them.
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <chrono>
#include <thread>

#include "tests/unit/core/job_kinds.h"
#include "tests/unit/dose.h"

namespace latvox {
namespace {

constexpr uint32_t kTetrahedra = 4500;  // 18,000 triangles: more than the largest part of any loop over them

struct Tiles {
  std::vector<TileBricks> tiles;
  absl::StatusOr<bool> done = false;
  JobTotals totals;
};

Tiles TilesOf(VoxelizeJob& job, int threads) {
  Tiles out;
  oneapi::tbb::task_arena(threads).execute([&] {
    out.done = job.Advance([&](TileBricks&& tile) {
      out.tiles.push_back(std::move(tile));
      return true;
    });
  });
  out.totals = job.totals();
  return out;
}

void ExpectSame(const Tiles& a, const Tiles& b) {
  EXPECT_EQ(a.totals.digest, b.totals.digest);
  EXPECT_EQ(a.totals.fields, b.totals.fields);
  ASSERT_EQ(a.tiles.size(), b.tiles.size());
  for (size_t n = 0; n < a.tiles.size(); ++n) {
    EXPECT_EQ(a.tiles[n].tile_ijk, b.tiles[n].tile_ijk);
    EXPECT_EQ(a.tiles[n].fields, b.tiles[n].fields);
  }
}

TEST(Threads, GiveTheSameAndEndOnceCancelledForEveryKindOfJob) {
  const oneapi::tbb::global_control threads(oneapi::tbb::global_control::max_allowed_parallelism, 4);
  const TriangleMesh heap = HeapOfTetrahedra(kTetrahedra, 140, 1);
  for (const JobKind& kind : JobKinds()) {
    SCOPED_TRACE(kind.name);
    const auto start = std::chrono::steady_clock::now();
    const Tiles one = TilesOf(*kind.Job(heap), 1);
    const auto whole = std::chrono::steady_clock::now() - start;
    ASSERT_TRUE(one.done.ok() && *one.done) << one.done.status();
    EXPECT_GT(one.totals.voxels, 4000U);
    EXPECT_GT(one.tiles.size(), 20U);
    const Tiles four = TilesOf(*kind.Job(heap), 4);
    ASSERT_TRUE(four.done.ok() && *four.done) << four.done.status();
    ExpectSame(one, four);
    // Cancels at different stages: no result of interrupted work may be used.
    for (const int part : Dose<std::vector<int>>({0, 1, 3, 5}, {1, 5})) {
      const auto job = kind.Job(heap);
      std::thread canceller([&] {
        std::this_thread::sleep_for(whole * part / 10);
        job->Cancel();
      });
      const Tiles tiles = TilesOf(*job, 4);
      canceller.join();
      EXPECT_TRUE(tiles.done.ok() || absl::IsCancelled(tiles.done.status())) << tiles.done.status();
      EXPECT_TRUE(absl::IsCancelled(TilesOf(*job, 4).done.status()));
    }
  }
}

}  // namespace
}  // namespace latvox
