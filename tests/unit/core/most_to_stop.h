// Measures how long work continues after it is cancelled, for tests of work that promises to end soon.
#ifndef LATVOX_TESTS_UNIT_CORE_MOST_TO_STOP_H_
#define LATVOX_TESTS_UNIT_CORE_MOST_TO_STOP_H_

#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <ctime>
#include <limits>
#include <memory>
#include <thread>

#include "core/voxelizer/voxelizer.h"
#include "tests/unit/core/job_kinds.h"

namespace latvox {

inline constexpr double kPromised = 0.05;  // seconds

// Work that ends within the promised time passes without being stopped: it must take several times as long.
inline constexpr double kLeastWork = 3 * kPromised;

inline constexpr int kMostDoubled = 5, kMostTries = 4;

// The CPU time of this process. Unlike the time of a clock, it does not depend on how busy the machine is.
inline double CpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// Returns the longest time from a cancel to the end of the work, of cancels at five points of it.
//   size         doubled until the work takes long enough, so that a faster machine tests as much
//   input(size)  returns the input of the work
//   make(input)  returns a pointer to work with Run(), on one thread, and Cancel()
template <class Input, class Make>
double MostToStop(uint32_t size, const Input& input, const Make& make) {
  auto in = input(size);
  const auto seconds = [&] {
    const auto work = make(in);
    const double begun = CpuSeconds();
    work->Run();
    return CpuSeconds() - begun;
  };
  double whole = seconds();
  for (int doubled = 0; whole < kLeastWork; ++doubled) {
    if (doubled == kMostDoubled) return std::numeric_limits<double>::infinity();  // does no work
    in = input(size *= 2);
    whole = seconds();
  }
  const auto to_stop = [&](double part) {
    const auto work = make(in);
    std::atomic<bool> over = false;
    double cancelled = 0;
    std::thread canceller([&, start = CpuSeconds()] {
      while (CpuSeconds() - start < part * whole && !over) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      work->Cancel();
      cancelled = CpuSeconds();  // not earlier, because this thread may have to wait in between
    });
    work->Run();
    const double end = CpuSeconds();
    over = true;
    canceller.join();
    return end - cancelled;
  };
  double most = 0;
  for (const double part : {0.1, 0.3, 0.5, 0.7, 0.9}) {
    // Programs beside it empty the caches, so that the same work takes more CPU time.
    double least = to_stop(part);
    for (int tries = 1; tries < kMostTries && least >= kPromised; ++tries) least = std::min(least, to_stop(part));
    most = std::max(most, least);
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

inline double MostToStopJob(uint32_t size, TriangleMesh (*mesh)(uint32_t size), const JobKind& kind) {
  return MostToStop(size, mesh, [&](const TriangleMesh& in) { return std::make_unique<Digitizing>(kind.Job(in)); });
}

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_CORE_MOST_TO_STOP_H_
