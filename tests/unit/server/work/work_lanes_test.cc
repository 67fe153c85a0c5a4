#include "server/work/work_lanes.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace latvox {
namespace {

using namespace std::chrono_literals;

TEST(WorkLanes, ClientsHaveLanesOfTheirOwnWhileTheyHoldThem) {
  WorkLanes lanes(1, 0);
  const auto a = lanes.LaneOf("a"), b = lanes.LaneOf("b"), a_again = lanes.LaneOf("a");
  EXPECT_EQ(a, a_again);
  EXPECT_NE(a, b);
  std::set<WorkQueue*> taken;
  for (int round = 0; round < 3; ++round) taken.insert(lanes.LaneOf("c").get());  // released at once
  EXPECT_FALSE(taken.contains(a.get()) || taken.contains(b.get()));
}

TEST(WorkLanes, MoreClientsShareTheLanesEvenly) {
  WorkLanes lanes(1, 0);
  std::vector<std::shared_ptr<WorkQueue>> held;
  std::multiset<WorkQueue*> taken;
  for (int n = 0; n < 3 * WorkLanes::kLanes; ++n) {
    held.push_back(lanes.LaneOf(std::to_string(n)));
    taken.insert(held.back().get());
  }
  for (const auto& lane : held) EXPECT_EQ(taken.count(lane.get()), 3);
}

TEST(WorkLanes, ATaskOfOneClientRunsBesideATaskOfAnotherThatNeverMakesWay) {
  WorkLanes lanes(1, 10);
  const auto hostile = lanes.LaneOf("hostile"), other = lanes.LaneOf("other");
  std::atomic<bool> over = false;
  hostile->Enqueue([&] {
    while (!over) {
    }
  });
  std::promise<void> ran;
  other->Enqueue([&] { ran.set_value(); });
  EXPECT_EQ(ran.get_future().wait_for(10s), std::future_status::ready);
  over = true;
  lanes.Wait();
}

}  // namespace
}  // namespace latvox
