// Turns: who is admitted, who works, and who waits.
#include "server/calls/call_registry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/time/clock.h"
#include "server/base/errors.h"

namespace latvox {
namespace {

using ::testing::HasSubstr;

class FakeCall : public LiveCall {
 public:
  void Stop(const absl::Status& status) override { stopped = status; }
  void Work() override { ++turns; }
  void WorkHere() override {
    ++turns;
    ++here_turns;
  }
  void Oversee() override { ++looks; }
  void EndIfStalled(absl::Duration patience) override { patience_asked = patience; }
  absl::Status stopped;
  int turns = 0, here_turns = 0, looks = 0;
  absl::Duration patience_asked;
};

std::shared_ptr<FakeCall> Enter(CallRegistry& registry, const std::string& client) {
  auto call = std::make_shared<FakeCall>();
  EXPECT_TRUE(registry.Admit(call, client).ok());
  return call;
}

std::shared_ptr<FakeCall> EnterAndWait(CallRegistry& registry, const std::string& client) {
  auto call = Enter(registry, client);
  registry.AwaitTurn(call.get());
  return call;
}

TEST(CallRegistry, AdmitsUpToItsLimitAndAgainOnceAPlaceIsVacated) {
  CallRegistry registry({1, 1, 9});
  const auto a = Enter(registry, "x"), b = Enter(registry, "y"), c = std::make_shared<FakeCall>();
  const absl::Status full = registry.Admit(c, "z");
  EXPECT_EQ(full.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(full.message()), HasSubstr("jobs: 2 of 2 are in progress"));
  EXPECT_TRUE(RetryDelayOf(full));
  registry.Vacate(a.get());
  EXPECT_TRUE(registry.Admit(c, "z").ok());
  EXPECT_EQ(registry.size(), 3);
  for (const auto& call : {a, b, c}) registry.Remove(call.get());
  registry.Remove(a.get());
  EXPECT_TRUE(registry.WaitUntilEmpty(absl::ZeroDuration()));
  EXPECT_EQ(registry.working() + registry.queued(), 0);
}

TEST(CallRegistry, TellsACallThatAsksWhetherItHasItsTurnAtOnce) {
  CallRegistry registry({1, 2, 9});
  const auto first = EnterAndWait(registry, "x"), second = EnterAndWait(registry, "y");
  EXPECT_TRUE(first->turns == 1 && first->here_turns == 1);
  registry.Vacate(first.get());
  EXPECT_TRUE(second->turns == 1 && second->here_turns == 0);
}

TEST(CallRegistry, OverseesCallsAtWorkAlone) {
  CallRegistry registry({1, 2, 9});
  const auto working = EnterAndWait(registry, "x"), waiting = EnterAndWait(registry, "y"),
             reading = Enter(registry, "z");
  registry.Oversee();
  EXPECT_EQ(working->looks, 1);
  EXPECT_EQ(waiting->looks + reading->looks, 0);
}

TEST(CallRegistry, WaitsForWork) {
  CallRegistry registry({1, 1, 9});
  registry.WaitForWork(absl::Milliseconds(1));  // in vain
  const auto call = Enter(registry, "x");
  std::jthread worker([&] {
    absl::SleepFor(absl::Milliseconds(20));
    registry.AwaitTurn(call.get());
  });
  registry.WaitForWork(absl::Seconds(20));
  EXPECT_EQ(registry.working(), 1);
  worker.join();
  registry.Pause(call.get());
  registry.Close();
  registry.WaitForWork(absl::Seconds(20));  // ends at once
}

TEST(CallRegistry, HasRoomForAsManyAsNumbersSay) {
  CallRegistry registry({1, UINT32_MAX, 9});
  const auto a = Enter(registry, "x");
  registry.Remove(a.get());
}

TEST(CallRegistry, HoldsEachClientAgainstItsShare) {
  CallRegistry registry({4, 4, 2});
  const auto a = Enter(registry, "x"), b = EnterAndWait(registry, "x");
  const absl::Status over = registry.Admit(std::make_shared<FakeCall>(), "x");
  EXPECT_EQ(over.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(over.message()), HasSubstr("jobs_of_client: 2 of 2"));
  EXPECT_TRUE(RetryDelayOf(over));
  EXPECT_TRUE(registry.Admit(std::make_shared<FakeCall>(), "y", 1).ok());
  EXPECT_FALSE(registry.Admit(std::make_shared<FakeCall>(), "y", 1).ok()) << "its own share is one";
  EXPECT_TRUE(registry.Admit(std::make_shared<FakeCall>(), "y", 5).ok()) << "no more than that of all, which is two";
  EXPECT_FALSE(registry.Admit(std::make_shared<FakeCall>(), "y", 5).ok());
  registry.Remove(a.get());
  EXPECT_TRUE(registry.Admit(std::make_shared<FakeCall>(), "x").ok());
}

TEST(CallRegistry, GivesTurnsUpToItsLimitAndThenAsPlacesAreVacated) {
  CallRegistry registry({2, 9, 9});
  std::vector<std::shared_ptr<FakeCall>> calls;
  for (int n = 0; n < 5; ++n) calls.push_back(EnterAndWait(registry, "x"));
  const auto turns = [&] {
    std::string text;
    for (const auto& call : calls) text += static_cast<char>('0' + call->turns);
    return text;
  };
  EXPECT_EQ(turns(), "11000");
  EXPECT_EQ(registry.working(), 2);
  EXPECT_EQ(registry.queued(), 3);
  registry.Vacate(calls[1].get());
  EXPECT_EQ(turns(), "11100");
  registry.Remove(calls[1].get());
  EXPECT_EQ(turns(), "11100") << "its place was vacated before";
  registry.Remove(calls[3].get());  // gives up waiting
  registry.Remove(calls[0].get());
  EXPECT_EQ(turns(), "11101");
}

TEST(CallRegistry, ACallThatStillReceivesTakesNoTurn) {
  CallRegistry registry({1, 9, 9});
  const auto receiving = Enter(registry, "x"), ready = EnterAndWait(registry, "x");
  EXPECT_EQ(receiving->turns, 0);
  EXPECT_EQ(ready->turns, 1);
}

TEST(CallRegistry, PrefersTheClientThatHasTheFewestAtWork) {
  CallRegistry registry({2, 9, 9});
  std::vector<std::shared_ptr<FakeCall>> many;
  for (int n = 0; n < 6; ++n) many.push_back(EnterAndWait(registry, "many"));
  const auto one = EnterAndWait(registry, "one");
  registry.Remove(many[0].get());
  EXPECT_EQ(one->turns, 1) << "although five had waited longer";
  registry.Remove(many[1].get());
  EXPECT_EQ(many[2]->turns, 1);
}

TEST(CallRegistry, StopsItsCallsAndAdmitsNoneAfterClose) {
  CallRegistry registry({1, 9, 9});
  const auto working = EnterAndWait(registry, "x"), waiting = EnterAndWait(registry, "x"),
             receiving = Enter(registry, "x");
  registry.Close();
  EXPECT_TRUE(working->stopped.ok());
  EXPECT_TRUE(receiving->stopped.ok());
  EXPECT_EQ(waiting->stopped.code(), absl::StatusCode::kUnavailable);
  EXPECT_TRUE(RetryDelayOf(waiting->stopped));
  registry.AwaitTurn(receiving.get());
  EXPECT_EQ(receiving->stopped.code(), absl::StatusCode::kUnavailable) << "there is no place for it";
  const absl::Status closed = registry.Admit(std::make_shared<FakeCall>(), "y");
  EXPECT_EQ(closed.code(), absl::StatusCode::kUnavailable);
  EXPECT_TRUE(RetryDelayOf(closed));
  EXPECT_FALSE(registry.WaitUntilEmpty(absl::Milliseconds(1)));
  registry.StopAll();
  EXPECT_EQ(working->stopped.code(), absl::StatusCode::kUnavailable);
}

TEST(CallRegistry, ACallThatHasReceivedAfterCloseStillWorksIfThereIsAPlace) {
  CallRegistry registry({1, 9, 9});
  const auto receiving = Enter(registry, "x");
  registry.Close();
  registry.AwaitTurn(receiving.get());
  EXPECT_EQ(receiving->turns, 1);
  EXPECT_TRUE(receiving->stopped.ok());
}

TEST(CallRegistry, OthersHaveTheTurnOfACallThatPausesUntilItComesBack) {
  CallRegistry registry({1, 9, 9});
  const auto a = EnterAndWait(registry, "x"), b = EnterAndWait(registry, "x");
  EXPECT_EQ(b->turns, 0);
  registry.Pause(a.get());
  EXPECT_EQ(b->turns, 1);
  EXPECT_EQ(registry.paused(), 1);
  EXPECT_EQ(registry.working(), 1);
  EXPECT_EQ(registry.queued(), 0);
  registry.AwaitTurn(a.get());
  EXPECT_EQ(a->turns, 1) << "b has it";
  EXPECT_EQ(registry.paused(), 0);
  EXPECT_EQ(registry.queued(), 1);
  registry.Vacate(b.get());
  EXPECT_EQ(a->turns, 2);
  registry.Pause(a.get());
  registry.AwaitTurn(a.get());
  EXPECT_EQ(a->turns, 3) << "nobody else waits";
}

TEST(CallRegistry, APausedCallKeepsItsPlaceAndIsNotRefusedItsReturn) {
  CallRegistry registry({1, 1, 9});
  const auto a = EnterAndWait(registry, "x");
  registry.Pause(a.get());
  const auto b = EnterAndWait(registry, "y");
  EXPECT_EQ(registry.Admit(std::make_shared<FakeCall>(), "z").code(), absl::StatusCode::kResourceExhausted);
  registry.AwaitTurn(a.get());
  EXPECT_TRUE(a->stopped.ok());
  registry.Remove(b.get());
  EXPECT_EQ(a->turns, 2);
  registry.Pause(a.get());
  registry.Remove(a.get());
  EXPECT_EQ(registry.size() + registry.paused(), 0);
}

TEST(CallRegistry, APausedCallCountsToItsClientsShareButNotAsWorking) {
  CallRegistry registry({1, 9, 2});
  const auto a = EnterAndWait(registry, "x"), b = EnterAndWait(registry, "y"), c = EnterAndWait(registry, "x");
  EXPECT_EQ(registry.Admit(std::make_shared<FakeCall>(), "x").code(), absl::StatusCode::kResourceExhausted);
  registry.Pause(a.get());
  EXPECT_EQ(registry.Admit(std::make_shared<FakeCall>(), "x").code(), absl::StatusCode::kResourceExhausted);
  registry.Vacate(b.get());
  EXPECT_EQ(c->turns, 1);
  registry.Remove(a.get());
  EXPECT_TRUE(registry.Admit(std::make_shared<FakeCall>(), "x").ok());
}

TEST(CallRegistry, CallsThatComeBackAndNewOnesTakeTurns) {
  CallRegistry registry({1, 99, 99});
  std::vector<std::shared_ptr<FakeCall>> streams, fresh;
  const auto expect_turn = [](const std::shared_ptr<FakeCall>& call) { EXPECT_EQ(std::exchange(call->turns, 0), 1); };
  for (int n = 0; n < 3; ++n) {
    streams.push_back(EnterAndWait(registry, "x"));
    expect_turn(streams.back());
    registry.Pause(streams.back().get());
  }
  const auto holder = EnterAndWait(registry, "x");
  for (int n = 0; n < 3; ++n) fresh.push_back(EnterAndWait(registry, "x"));
  for (const auto& stream : streams) registry.AwaitTurn(stream.get());
  registry.Remove(holder.get());
  for (size_t n = 0; n < 3; ++n) {
    expect_turn(streams[n]);
    registry.AwaitTurn(fresh[n].get());  // once is enough
    registry.Pause(streams[n].get());
    expect_turn(fresh[n]);
    registry.AwaitTurn(streams[n].get());  // back at once
    registry.Remove(fresh[n].get());
  }
  expect_turn(streams[0]);
  registry.Pause(streams[0].get());
  expect_turn(streams[1]);
}

TEST(CallRegistry, ACallThatPausesWhileItWaitsHasNoTurnToCome) {
  CallRegistry registry({1, 9, 9});
  const auto holder = EnterAndWait(registry, "x"), ended = EnterAndWait(registry, "x"),
             next = EnterAndWait(registry, "x");
  registry.Pause(ended.get());
  registry.Remove(holder.get());
  EXPECT_EQ(ended->turns, 0);
  EXPECT_EQ(next->turns, 1);
}

TEST(CallRegistry, ACallThatHasBegunComesBackAfterClose) {
  CallRegistry registry({1, 9, 9});
  const auto paused = EnterAndWait(registry, "x");
  registry.Pause(paused.get());
  const auto working = EnterAndWait(registry, "x");
  registry.Close();
  registry.AwaitTurn(paused.get());
  registry.Remove(working.get());
  EXPECT_EQ(paused->turns, 2);
  EXPECT_TRUE(paused->stopped.ok());
}

TEST(CallRegistry, AsksEveryCallWhetherItsClientStalls) {
  CallRegistry registry({1, 9, 9});
  const auto working = EnterAndWait(registry, "x"), waiting = EnterAndWait(registry, "x");
  registry.EndStalled(absl::Seconds(7));
  EXPECT_EQ(working->patience_asked, absl::Seconds(7));
  EXPECT_EQ(waiting->patience_asked, absl::Seconds(7));
}

}  // namespace
}  // namespace latvox
