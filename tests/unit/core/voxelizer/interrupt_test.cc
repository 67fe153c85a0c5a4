// Interrupted jobs deliver the same in the end.
#include <gtest/gtest.h>

#include <cctype>
#include <chrono>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/voxelizer/voxelizer.h"
#include "tests/unit/core/job_kinds.h"

namespace latvox {
namespace {

struct Delivered {
  std::vector<Vec3i> tiles;
  JobTotals totals;
  int interruptions = 0;
};

// Interrupts the job at its first tile, and after 1 ms, then after 2 ms, 4 ms, and so on.
Delivered RunInterrupted(VoxelizeJob& job) {
  Delivered delivered;
  for (std::chrono::milliseconds patience{1};; patience *= 2) {
    std::jthread interrupter([&job, patience](const std::stop_token& over) {
      const auto end = std::chrono::steady_clock::now() + patience;
      while (!over.stop_requested() && std::chrono::steady_clock::now() < end) std::this_thread::yield();
      job.Interrupt();
    });
    const absl::StatusOr<bool> done = job.Advance([&](TileBricks&& tile) {
      if (delivered.tiles.empty()) job.Interrupt();
      delivered.tiles.push_back(tile.tile_ijk);
      return true;
    });
    EXPECT_TRUE(done.ok()) << done.status();
    if (!done.ok() || *done) break;
    ++delivered.interruptions;
  }
  delivered.totals = job.totals();
  return delivered;
}

Delivered RunWhole(VoxelizeJob& job) {
  Delivered delivered;
  const absl::StatusOr<bool> done = job.Advance([&](TileBricks&& tile) {
    delivered.tiles.push_back(tile.tile_ijk);
    return true;
  });
  EXPECT_TRUE(done.ok() && *done);
  delivered.totals = job.totals();
  return delivered;
}

class EveryKindOfJob : public testing::TestWithParam<JobKind> {};

TEST_P(EveryKindOfJob, DeliversTheSame) {
  const TriangleMesh heap = HeapOfTetrahedra(GetParam().tetrahedra / 8, 150);
  const Delivered whole = RunWhole(*GetParam().Job(heap));
  const Delivered parts = RunInterrupted(*GetParam().Job(heap));
  EXPECT_EQ(parts.tiles, whole.tiles);
  EXPECT_EQ(parts.totals.voxels, whole.totals.voxels);
  EXPECT_EQ(parts.totals.digest, whole.totals.digest);
  EXPECT_EQ(parts.totals.fields, whole.totals.fields);
  if (GetParam().options.algorithm == Algorithm::kExact) {
    EXPECT_GT(parts.interruptions, 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Interrupting, EveryKindOfJob, testing::ValuesIn(JobKinds()), [](const auto& kind) {
  std::string name = kind.param.name;
  std::erase_if(name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; });
  return name;
});

TEST(Interrupting, DoesNotMatterBetweenAdvances) {
  const auto job = JobKinds().front().Job(HeapOfTetrahedra(10));
  job->Interrupt();
  const absl::StatusOr<bool> done = job->Advance([](TileBricks&&) { return true; });
  ASSERT_TRUE(done.ok());
  EXPECT_TRUE(*done);
}

}  // namespace
}  // namespace latvox
