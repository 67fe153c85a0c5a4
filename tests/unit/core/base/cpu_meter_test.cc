#include "core/base/cpu_meter.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/task_arena.h>

#include <atomic>
#include <chrono>
#include <ctime>
#include <functional>
#include <optional>
#include <thread>

#include "core/base/metered.h"

namespace latvox {
namespace {

void BusyFor(std::chrono::milliseconds time) {
  const std::clock_t end = std::clock() + time.count() * CLOCKS_PER_SEC / 1000;
  while (std::clock() < end) {
  }
}

TEST(CpuMeter, CountsScopesThatHaveEnded) {
  CpuMeter meter;
  EXPECT_EQ(meter.Seconds(), 0);
  std::optional<CpuMeter::Scope> scope(meter);
  BusyFor(std::chrono::milliseconds(30));
  scope.reset();
  const double seconds = meter.Seconds();
  EXPECT_GE(seconds, 0.02);
  BusyFor(std::chrono::milliseconds(30));
  EXPECT_EQ(meter.Seconds(), seconds);
}

TEST(CpuMeter, CountsThreadsThatAreAtWork) {
  CpuMeter meter;
  std::atomic<bool> over = false;
  std::jthread worker([&] {
    const CpuMeter::Scope scope(meter);
    while (!over) {
    }
  });
  while (meter.Seconds() < 0.03) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  over = true;
  worker.join();
  EXPECT_GE(meter.Seconds(), 0.03);
}

TEST(CpuMeter, CountsAScopeWithinAnotherOnce) {
  CpuMeter meter;
  const std::clock_t begin = std::clock();
  {
    const CpuMeter::Scope outer(meter);
    BusyFor(std::chrono::milliseconds(20));
    {
      const CpuMeter::Scope inner(meter);
      BusyFor(std::chrono::milliseconds(30));
    }
    EXPECT_GE(meter.Seconds(), 0.04);
    BusyFor(std::chrono::milliseconds(20));
  }
  EXPECT_GE(meter.Seconds(), 0.06);
  EXPECT_LE(meter.Seconds(), static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC + 0.01);
}

TEST(CpuMeter, IsThatOfTheInnermostScope) {
  CpuMeter meter, other;
  EXPECT_EQ(CpuMeter::OfThread(), nullptr);
  {
    const CpuMeter::Scope outer(meter);
    {
      const CpuMeter::Scope inner(other);
      EXPECT_EQ(CpuMeter::OfThread(), &other);
      const CpuMeter::Scope none(nullptr);
      EXPECT_EQ(CpuMeter::OfThread(), nullptr);
    }
    EXPECT_EQ(CpuMeter::OfThread(), &meter);
  }
  EXPECT_EQ(CpuMeter::OfThread(), nullptr);
}

// The time of this thread, in milliseconds.
double Now() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
}

TEST(Metered, CountsParallelWorkOnAllThreads) {
  constexpr size_t kParts = 16;
  constexpr double kMilliseconds = 5;
  using Part = oneapi::tbb::blocked_range<size_t>;
  const auto work = [](const Part& part) {
    const double end = Now() + kMilliseconds * static_cast<double>(part.size());
    while (Now() < end) {
    }
    return part.size();
  };
  CpuMeter meter;
  oneapi::tbb::task_arena arena(4);
  arena.execute([&] {
    const CpuMeter::Scope scope(meter);
    MeteredFor(Part(0, kParts), work);
    const size_t parts = MeteredReduce(
        Part(0, kParts), size_t{0}, [&](const Part& part, size_t sum) { return sum + work(part); }, std::plus<>());
    EXPECT_EQ(parts, kParts);
  });
  EXPECT_GE(meter.Seconds(), 2 * kParts * kMilliseconds * 1e-3);
  const double seconds = meter.Seconds();
  arena.execute([&] { MeteredFor(Part(0, kParts), work); });
  EXPECT_EQ(meter.Seconds(), seconds) << "outside of scopes, nothing counts";
}

TEST(CpuMeter, DoesNotCountWaiting) {
  CpuMeter meter;
  {
    const CpuMeter::Scope scope(meter);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  EXPECT_LT(meter.Seconds(), 0.05);
}

}  // namespace
}  // namespace latvox
