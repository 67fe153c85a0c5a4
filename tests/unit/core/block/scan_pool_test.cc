// The memory that jobs leave to later ones.
#include "core/block/scan_pool.h"

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <random>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/kept_memory.h"
#include "core/block/tile_job.h"
#include "core/voxelizer/voxelizer.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/sphere.h"
#include "tests/unit/dose.h"

namespace latvox {
namespace {

class ScanPoolTest : public testing::Test {
 protected:
  ~ScanPoolTest() override { KeepJobMemory(kKeptByDefault); }
};

template <int kNumber>
struct Sized {
  bool used = false;
  size_t Bytes() const { return 10; }
};

// Runs a job that uses so many scans at a time, and leaves them to later jobs. Returns the number of scans that had
// been used before.
template <class Scan>
int UsedBefore(int count) {
  ScanPool<Scan> pool;
  std::vector<std::unique_ptr<Scan>> scans;
  int used = 0;
  for (int n = 0; n < count; ++n) {
    scans.push_back(pool.Reserve());
    used += scans.back()->used ? 1 : 0;
    scans.back()->used = true;
  }
  for (auto& scan : scans) pool.Release(std::move(scan));
  pool.Leave();
  return used;
}

TEST_F(ScanPoolTest, LeavesScansByDefault) {
  EXPECT_EQ(UsedBefore<Sized<0>>(3), 0);
  EXPECT_EQ(UsedBefore<Sized<0>>(3), 3);
}

TEST_F(ScanPoolTest, LeavesScansUpToALimit) {
  kept_scan_bytes = 29;
  EXPECT_EQ(UsedBefore<Sized<1>>(4), 0);
  EXPECT_EQ(UsedBefore<Sized<1>>(1), 1);
  EXPECT_EQ(UsedBefore<Sized<1>>(4), 2);
  kept_scan_bytes = 0;
  EXPECT_EQ(UsedBefore<Sized<1>>(4), 2);
  EXPECT_EQ(UsedBefore<Sized<1>>(4), 0);
}

// The jobs differ in lattice, neighbors, fineness and kind, and some are cancelled midway.
TEST_F(ScanPoolTest, JobsGiveTheSameTilesWithWhatEarlierJobsHaveLeft) {
  struct Case {
    TriangleMesh mesh;
    Grid grid;
    VoxelizeOptions options;
  };
  std::vector<Case> cases;
  for (const NamedLattice lattice : {NamedLattice::kCartesian, NamedLattice::kFcc}) {
    const Grid grid = Unscaled(Lattice::Named(lattice));
    for (const TriangleMesh& mesh : {Sphere(160, 14), Sphere(30, 150), Sphere(5, 90)}) {
      for (const int k : {0, 2}) cases.push_back({mesh, grid, {.separability = k}});
      for (const InteriorRule rule : {InteriorRule::kParity, InteriorRule::kWinding}) {
        cases.push_back({mesh, grid, {.set = Solid{.rule = rule}}});
      }
      TriangleMesh open = mesh;
      open.triangles.pop_back();
      cases.push_back({open, grid, {.set = Solid{.force_open = true}}});
      cases.push_back({mesh, grid, {.minimal = false}});
      cases.push_back({mesh, grid, {.set = SupercoverSurface{}}});
    }
  }
  const auto digest = [](const Case& c) { return Voxelize(c.mesh, c.grid, c.options, 2).totals.digest; };
  std::vector<Digest> expected;
  for (const Case& c : cases) expected.push_back(digest(c));
  kept_scan_bytes = size_t{64} << 20;
  constexpr unsigned kSeed = 7;
  std::mt19937 random(kSeed);
  std::uniform_int_distribution<size_t> any(0, cases.size() - 1);
  for (int times = 0; times < Dose(120, 40); ++times) {
    const size_t n = any(random);
    auto cancelled = *VoxelizeJob::Create(cases[n].mesh, cases[n].grid, cases[n].options);
    std::thread other([&, wait = std::chrono::microseconds(random() % 2000)] {
      std::this_thread::sleep_for(wait);
      cancelled->Cancel();
    });
    (void)cancelled->Advance([](TileBricks&&) { return true; });
    other.join();
    cancelled.reset();
    EXPECT_EQ(digest(cases[n]), expected[n]) << "case " << n << " seed " << kSeed;
  }
  int left = 0;
  while (LeftScans<BlockScan>::Get().Reserve() != nullptr) ++left;
  EXPECT_GT(left, 0);
}

}  // namespace
}  // namespace latvox
