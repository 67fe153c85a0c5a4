#include "client/tool/output/outputs.h"

#include <gmock/gmock.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <atomic>
#include <latch>
#include <new>

#include "absl/strings/str_cat.h"

namespace latvox::client {
namespace {

struct Numbered final : Output {
  explicit Numbered(int n) : number(n) {}
  absl::Status Begin(const Accepted&) override { return absl::OkStatus(); }
  absl::Status Add(const BrickBatch&) override { return absl::OkStatus(); }
  absl::Status Finish(const Summary&) override { return absl::OkStatus(); }
  absl::Status Commit() override {
    committed = true;
    return number == 2 ? absl::FailedPreconditionError("2") : absl::OkStatus();
  }

  const int number;
  bool committed = false;
};

int NumberOf(const Output& output) { return dynamic_cast<const Numbered&>(output).number; }

Outputs Several(int count) {
  Outputs outputs;
  for (int n = 0; n < count; ++n) outputs.push_back(std::make_unique<Numbered>(n));
  return outputs;
}

TEST(Outputs, AreWrittenAtOnce) {
  const tbb::global_control two_threads(tbb::global_control::max_allowed_parallelism, 2);  // also on one core
  tbb::task_arena two(2);
  two.execute([] {
    std::latch both(2);
    const auto meet = [&both](Output&) {
      both.arrive_and_wait();  // forever, if one step waits for the end of the other
      return absl::OkStatus();
    };
    EXPECT_TRUE(ForAllAtOnce(Several(2), {}, meet).ok());
  });
}

TEST(Outputs, TheFirstErrorInTheirOrderIsReportedAndAllStepsEnd) {
  std::atomic<int> steps = 0;
  const auto fail = [&steps](Output& output) {
    ++steps;
    const int n = NumberOf(output);
    return n % 3 == 1 ? absl::FailedPreconditionError(absl::StrCat(n)) : absl::OkStatus();
  };
  EXPECT_EQ(ForAllAtOnce(Several(9), {}, fail), absl::FailedPreconditionError("1"));
  EXPECT_EQ(steps, 9);
}

TEST(Outputs, AStepWithoutMemoryIsAnErrorOfItsOwn) {
  std::atomic<int> steps = 0;
  const auto fail = [&steps](Output& output) {
    ++steps;
    if (NumberOf(output) == 1) throw std::bad_alloc();
    return absl::OkStatus();
  };
  EXPECT_EQ(ForAllAtOnce(Several(4), {}, fail).code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(steps, 4);
}

TEST(Outputs, NoStepBeginsAfterACancellation) {
  const Cancellation cancellation;
  cancellation.Cancel();
  int steps = 0;
  const auto count = [&steps](Output&) { return ++steps, absl::OkStatus(); };
  EXPECT_EQ(ForAllAtOnce(Several(3), cancellation, count).code(), absl::StatusCode::kCancelled);
  EXPECT_EQ(steps, 0);
}

TEST(Outputs, NoneIsCommittedAfterOneThatFails) {
  const Outputs outputs = Several(4);
  EXPECT_EQ(CommitAll(outputs), absl::FailedPreconditionError("2"));
  for (const auto& output : outputs) {
    EXPECT_EQ(dynamic_cast<const Numbered&>(*output).committed, NumberOf(*output) <= 2);
  }
}

}  // namespace
}  // namespace latvox::client
