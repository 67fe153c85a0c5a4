// The memory of all jobs, and each client's share.
#include "server/work/memory_budget.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "server/base/errors.h"

namespace latvox {
namespace {

TEST(MemoryBudget, IsSharedAndGivenBack) {
  MemoryBudget budget(100);
  MemoryReservation a(budget);
  {
    MemoryReservation b(budget);
    EXPECT_TRUE(a.Grow(60).ok());
    EXPECT_TRUE(a.Grow(50).ok()) << "has that";
    EXPECT_TRUE(b.Grow(40).ok());
    EXPECT_EQ(budget.reserved(), 100);
    const absl::Status busy = b.Grow(41);
    EXPECT_EQ(busy.code(), absl::StatusCode::kResourceExhausted);
    EXPECT_EQ(busy.message(), "memory: 41 bytes are needed, and others have 60 of 100; try again");
    EXPECT_TRUE(RetryDelayOf(busy));
    const absl::Status never = b.Grow(101);
    EXPECT_EQ(never.message(), "memory 101 exceeds 100");
    EXPECT_FALSE(RetryDelayOf(never));
  }
  EXPECT_EQ(budget.reserved(), 60);
  EXPECT_TRUE(a.Grow(100).ok());
  a.Shrink(10);
  a.Shrink(20);
  EXPECT_EQ(a.bytes(), 10);
  EXPECT_EQ(budget.reserved(), 10);
}

TEST(MemoryBudget, AClientThatIsInTheWayOfAnotherGetsNoMoreThanHalf) {
  MemoryBudget budget(100);
  MemoryReservation first(budget, "a"), second(budget, "a"), other(budget, "b");
  EXPECT_TRUE(first.Grow(80).ok()) << "alone";
  EXPECT_FALSE(budget.WasShort());
  EXPECT_FALSE(other.Grow(30).ok());
  EXPECT_TRUE(budget.WasShort());
  EXPECT_FALSE(budget.WasShort());
  first.Shrink(40);
  EXPECT_EQ(second.Grow(20).message(),
            "memory: 20 bytes are needed, and other jobs of this client have 40 of its share of 50; try again");
  EXPECT_TRUE(other.Grow(30).ok());
  EXPECT_TRUE(second.Grow(10).ok());
  EXPECT_EQ(budget.reserved(), 80);
}

TEST(MemoryBudget, RefusesSizesThatWouldWrapAround) {
  MemoryBudget budget(100);
  MemoryReservation a(budget), b(budget);
  ASSERT_TRUE(a.Grow(100).ok());
  EXPECT_FALSE(b.Grow(UINT64_MAX).ok());
  EXPECT_FALSE(a.Grow(UINT64_MAX).ok());
  EXPECT_EQ(budget.reserved(), 100);
}

TEST(DefaultMemoryBudget, IsLessThanTheMachineHas) {
  EXPECT_GT(DefaultMemoryBudget(), uint64_t{64} << 20);
  EXPECT_LT(DefaultMemoryBudget(), uint64_t{1} << 50);
}

TEST(DefaultMemoryBudget, IsHalfForOneThatSharesItButWhatItNeedsToStart) {
  constexpr uint64_t kMiB = uint64_t{1} << 20;
  for (const auto& [all, shared] : {std::pair<uint64_t, uint64_t>{6144, 3072}, {512, 256}, {384, 256}, {100, 100}}) {
    EXPECT_EQ(SharedMemoryBudget(all * kMiB), shared * kMiB) << all;
  }
}

}  // namespace
}  // namespace latvox
