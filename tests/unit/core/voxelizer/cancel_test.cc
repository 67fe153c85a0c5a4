// Work that is cancelled ends soon, wherever it is: also where very many triangles, or lines, meet.
#include <gtest/gtest.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <chrono>
#include <ctime>
#include <memory>
#include <optional>
#include <random>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/sort.h"
#include "core/base/stop_signal.h"
#include "core/plane/pixelize.h"
#include "core/voxelizer/voxelizer.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/job_kinds.h"
#include "tests/unit/core/sphere.h"

namespace latvox {
namespace {

constexpr double kPromised = 0.05;  // seconds

// Of this process: of work by one thread, the time that it takes, but for what others do to the machine.
double CpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// The longest time from a cancel to the end of the work, of cancels at five points of it.
//   make()   what has Run, which takes a while, and Cancel
template <class Make>
double MostToStop(const Make& make) {
  const double begun = CpuSeconds();
  make()->Run();
  const double whole = CpuSeconds() - begun;
  double most = 0;
  for (const double part : {0.1, 0.3, 0.5, 0.7, 0.9}) {
    const auto work = make();
    std::atomic<bool> over = false;
    double cancelled = 0;
    std::thread canceller([&, start = CpuSeconds()] {
      while (CpuSeconds() - start < part * whole && !over) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      work->Cancel();
      cancelled = CpuSeconds();  // not before, lest this thread be kept waiting in between
    });
    work->Run();
    const double end = CpuSeconds();
    over = true;
    canceller.join();
    most = std::max(most, end - cancelled);
  }
  return most;
}

struct Digitizing {
  std::unique_ptr<VoxelizeJob> job;
  void Run() {
    oneapi::tbb::task_arena(1).execute([&] { job->Advance([](TileBricks&&) { return true; }).IgnoreError(); });
  }
  void Cancel() { job->Cancel(); }
};

// Triangles some voxels wide, in a single tile.
TriangleMesh Heap(uint32_t triangles) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> place(0, 40), corner(-1.5, 1.5);
  TriangleMesh heap;
  for (uint32_t n = 0; n < 3 * triangles; n += 3) {
    const Vec3f at{place(random), place(random), place(random)};
    for (int c = 0; c < 3; ++c) {
      heap.vertices.push_back({at[0] + corner(random), at[1] + corner(random), at[2] + corner(random)});
    }
    heap.triangles.push_back({n, n + 1, n + 2});
  }
  return heap;
}

TEST(Cancelling, StopsAHeapOfTrianglesInOneTile) {
  const TriangleMesh heap = Heap(40000);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  EXPECT_LT(MostToStop([&] { return std::make_unique<Digitizing>(*VoxelizeJob::Create(heap, grid, {})); }), kPromised);
}

TEST(Cancelling, StopsEveryKindOfJob) {
  for (const JobKind& kind : JobKinds()) {
    const TriangleMesh heap = HeapOfTetrahedra(kind.tetrahedra);
    EXPECT_LT(MostToStop([&] { return std::make_unique<Digitizing>(kind.Job(heap)); }), kPromised) << kind.name;
  }
}

// Before and after their scans the thesis's algorithms sort edges, voxels and tiles.
TEST(Cancelling, StopsTheThesissAlgorithmsOnManyTrianglesAndOnLargeOnes) {
  const JobKind kind{"", 0, {.algorithm = Algorithm::kOptimizedIncremental}};
  for (const TriangleMesh& mesh : {Sphere(300, 150), Sphere(20, 800)}) {
    EXPECT_LT(MostToStop([&] { return std::make_unique<Digitizing>(kind.Job(mesh)); }), kPromised);
  }
}

struct Verifying : Digitizing {
  const VoxelSet voxels = {};
  void Run() {
    oneapi::tbb::task_arena(1).execute([&] { job->Verify(voxels).IgnoreError(); });
  }
};

TEST(Cancelling, StopsToVerifyInTheMiddleOfATriangle) {
  const TriangleMesh triangle{{{0, 0, 0}, {4000, 0, 100}, {0, 4000, 200}}, {{0, 1, 2}}};
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  EXPECT_LT(MostToStop([&] {
              auto job = *VoxelizeJob::Create(triangle, grid, {.separability = 2});
              return std::make_unique<Verifying>(Digitizing{std::move(job)});
            }),
            kPromised);
}

struct Pixelizing {
  std::vector<Polyline> polylines;
  PlaneGrid grid;
  PixelizeOptions options;
  StopSource source;
  void Run() { Pixelize(polylines, grid, options, source.Signal()).IgnoreError(); }
  void Cancel() { source.Stop(); }
};

TEST(Cancelling, StopsLongCurvesWithEveryAlgorithm) {
  const PlaneGrid grid{PlaneLattice::Named(NamedPlaneLattice::kSquare), {0, 0}};
  for (const auto& [algorithm, size] : {std::pair{LineAlgorithm::kCrossing, 60000.0},
                                        {LineAlgorithm::kBruteForce, 4000.0},
                                        {LineAlgorithm::kIbanez, 60000.0}}) {
    Polyline zigzag;
    for (int n = 0; n < 6; ++n) zigzag.points.push_back({n % 2 * size, n * size / 6});
    const PixelizeOptions options{.algorithm = algorithm};
    EXPECT_LT(MostToStop([&] { return std::make_unique<Pixelizing>(std::vector{zigzag}, grid, options); }), kPromised);
  }
}

TEST(Cancelling, SortingIsThatOfTheLibraryAndStops) {
  std::mt19937 random(3);
  for (const size_t size : {size_t{0}, size_t{1}, size_t{1} << 16, size_t{1000000}}) {
    std::vector<uint32_t> numbers(size);
    for (uint32_t& number : numbers) number = static_cast<uint32_t>(random() % 100000);
    std::vector<uint32_t> expected = numbers, unsorted = numbers;
    std::sort(expected.begin(), expected.end());
    Sort(numbers, StopSignal());
    EXPECT_EQ(numbers, expected);
    expected.erase(std::unique(expected.begin(), expected.end()), expected.end());
    std::vector<uint32_t> unique = unsorted;
    SortUnique(unique, StopSignal());
    EXPECT_EQ(unique, expected);
    const std::vector<uint32_t> before = unsorted;
    StopSource stopped;
    stopped.Stop();
    Sort(unsorted, stopped.Signal());
    EXPECT_EQ(unsorted, before);
  }
}

// At every stage: sorting pieces, four fifths of all comparisons here, and merging them, in the end all at once.
TEST(Cancelling, SortingStopsWithinAPieceAndLosesNothing) {
  constexpr uint64_t kToSortAPiece = 2 * kSortedPiece * std::bit_width(kSortedPiece);  // comparisons
  std::mt19937 random(4);
  std::vector<uint32_t> unsorted(1000000);
  for (uint32_t& number : unsorted) number = static_cast<uint32_t>(random() % 100000);
  std::vector<uint32_t> expected = unsorted;
  std::sort(expected.begin(), expected.end());
  std::optional<StopSource> source(std::in_place);
  uint64_t compared = 0, last = ~uint64_t{0};
  const auto less = [&](uint32_t a, uint32_t b) {
    if (++compared == last) source->Stop();
    return a < b;
  };
  std::vector<uint32_t> numbers = unsorted;
  Sort(numbers, source->Signal(), less);
  EXPECT_EQ(numbers, expected);
  const uint64_t whole = compared;
  for (const double part : {0.1, 0.5, 0.8, 0.9, 0.95, 0.98}) {
    numbers = unsorted;
    source.emplace();
    compared = 0;
    last = static_cast<uint64_t>(part * static_cast<double>(whole));
    Sort(numbers, source->Signal(), less);
    EXPECT_LT(compared - last, part < 0.85 ? kToSortAPiece : kSortedPiece + 1) << part;
    EXPECT_NE(numbers, expected);
    std::sort(numbers.begin(), numbers.end());
    EXPECT_EQ(numbers, expected);
  }
}

}  // namespace
}  // namespace latvox
