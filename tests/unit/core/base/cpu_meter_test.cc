#include "core/base/cpu_meter.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <optional>
#include <thread>

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
