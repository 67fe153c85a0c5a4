// Meshes decoded in processes of their own, and all that can become of these.
#include "server/decode/decoder_pool.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "server/base/errors.h"
#include "server/decode/draco_decoder.h"
#include "tests/unit/server/decode/decoder_pool.h"
#include "tests/unit/server/log_lines.h"
#include "tests/unit/server/meshes.h"

namespace latvox {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;

constexpr absl::Duration kAtOnce = absl::Milliseconds(50);

// Half a million triangles in some kilobytes.
const std::string& Dense() {
  static const auto& bytes = *new std::string(EncodeDraco(FlatGrid(512), {.quantization_bits = 10, .speed = 0}));
  return bytes;
}

TEST_F(DecoderPoolTest, GivesTheMeshesThatDracoGivesHere) {
  Start();
  for (const DracoMethod method : {DracoMethod::kSequential, DracoMethod::kEdgebreaker}) {
    for (const int bits : {0, 11, 21}) {
      for (const int rings : {2, 20, 120}) {
        const std::string bytes = EncodeDraco(Sphere(rings), {.method = method, .quantization_bits = bits});
        ExpectSame(Decode(*pool_, bytes).Get(), bytes);
      }
    }
  }
  EXPECT_EQ(pool_->facts().decodes, 18);
  EXPECT_EQ(pool_->facts().restarts, 0);
}

TEST_F(DecoderPoolTest, GivesTheErrorsThatDracoGivesHere) {
  Start();
  const std::string& good = Small();
  for (const std::string& bytes : {std::string("v 0 0 0\n"), good.substr(0, good.size() / 2), std::string("DRACO"),
                                   EncodeDracoPointCloud(Sphere(4))}) {
    ExpectSameError(Decode(*pool_, bytes).Get().status(), DecodeDraco(bytes, {}).status());
  }
  const Limits limits{.max_triangles = 100};
  ExpectSameError(Decode(*pool_, good, limits).Get().status(), DecodeDraco(good, limits).status());
  EXPECT_EQ(ReasonOf(Decode(*pool_, good, limits).Get().status()), "LIMIT_EXCEEDED");
  ExpectSame(Decode(*pool_, good).Get(), good);
  EXPECT_EQ(pool_->facts().restarts, 0);
}

TEST_F(DecoderPoolTest, DecodesManyAtOnce) {
  Start();
  std::vector<std::string> meshes;
  for (int rings = 2; rings < 60; ++rings) meshes.push_back(EncodeDraco(Sphere(rings), {}));
  meshes.push_back(Large());
  std::vector<std::unique_ptr<Decode>> decodes;
  for (int n = 0; n < 300; ++n) decodes.push_back(std::make_unique<Decode>(*pool_, meshes[n % meshes.size()]));
  for (int n = 0; n < 300; ++n) ExpectSame(decodes[n]->Get(), meshes[n % meshes.size()]);
  EXPECT_EQ(pool_->facts().decodes, 300);
}

TEST_F(DecoderPoolTest, SmallMeshesDoNotWaitForLargeOnes) {
  Start();
  ASSERT_GT(Large().size(), 2 << 20);
  ASSERT_LT(Dense().size(), 1 << 14);
  const std::vector<pid_t> pids = Running();
  for (const pid_t pid : pids) kill(pid, SIGSTOP);
  Decode first(*pool_, Large()), second(*pool_, Dense()), small(*pool_, Small());
  // One of the two has the first; the other must not have the second.
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  kill(pids[1], SIGCONT);
  ExpectSame(small.Get(), Small());
  EXPECT_FALSE(first.over());
  EXPECT_FALSE(second.over());
  kill(pids[0], SIGCONT);
  ExpectSame(first.Get(), Large());
  ExpectSame(second.Get(), Dense());
}

TEST_F(DecoderPoolTest, ClientsHaveTurns) {
  const pid_t pid = StartStopped();
  std::mutex mutex;
  std::string order;
  std::vector<std::unique_ptr<Decode>> decodes;
  for (const char* const client : {"a", "a", "a", "a", "b", "b", "c"}) {
    const auto note = [&mutex, &order, client](uint64_t, uint64_t) {
      const std::lock_guard lock(mutex);
      order += client;
      return absl::OkStatus();
    };
    decodes.push_back(std::make_unique<Decode>(*pool_, Small(), Limits(), note, FieldList(), client));
  }
  kill(pid, SIGCONT);
  for (const auto& decode : decodes) ExpectSame(decode->Get(), Small());
  EXPECT_EQ(order, "abcabaa");
}

TEST_F(DecoderPoolTest, ACancelledDecodeEndsAtOnceAndItsProcessIsReplaced) {
  StartStopped();
  uint64_t cancels = 0;
  absl::Duration least = absl::InfiniteDuration();
  while (least >= kAtOnce && cancels < 5) {  // on a busy machine, this process waits for its own turn
    if (cancels > 0) kill(Running().at(0), SIGSTOP);
    Decode decode(*pool_, Large());
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const absl::Time cancelled = absl::Now();
    decode.Cancel();
    EXPECT_EQ(decode.Get().status().code(), absl::StatusCode::kCancelled);
    least = std::min(least, decode.ended() - cancelled);
    decode.Cancel();  // once more does no harm
    ++cancels;
    ASSERT_TRUE(Eventually([&] { return pool_->facts().restarts == cancels && Running().size() == 1; }));
  }
  EXPECT_LT(least, kAtOnce);
  ExpectSame(Decode(*pool_, Small()).Get(), Small());
  EXPECT_EQ(pool_->facts().restarts, cancels);
  EXPECT_EQ(Children().size(), 1);
}

TEST_F(DecoderPoolTest, DecodesAreCancelledWhereverTheyAre) {
  Start();
  std::vector<std::unique_ptr<Decode>> decodes;
  for (int n = 0; n < 100; ++n) decodes.push_back(std::make_unique<Decode>(*pool_, n % 5 == 0 ? Large() : Small()));
  for (int n = 0; n < 100; n += 3) {
    if (n % 7 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    decodes[n]->Cancel();
  }
  for (int n = 0; n < 100; ++n) {
    const auto result = decodes[n]->Get();
    if (n % 3 == 0 && result.status().code() == absl::StatusCode::kCancelled) continue;
    ExpectSame(result, n % 5 == 0 ? Large() : Small());
  }
}

TEST_F(DecoderPoolTest, AProcessKilledInADecodeLosesNothing) {
  const pid_t pid = StartStopped();
  LogLines lines;
  Decode decode(*pool_, Large());
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  kill(pid, SIGKILL);
  ExpectSame(decode.Get(), Large());
  EXPECT_THAT(lines.End(), HasSubstr(absl::StrCat("event=decoder_died pid=", pid, " end=\"signal 9 (Killed)\" bytes=",
                                                  Large().size(), " request_id=id-7\n")));
  EXPECT_EQ(pool_->facts().restarts, 1);
  EXPECT_EQ(pool_->facts().crashes, 0);
}

// The process is killed after it has begun to send the mesh, which is too large for a socket's buffer.
TEST_F(DecoderPoolTest, AMeshWhoseProcessesAreAlwaysKilledIsGivenUp) {
  options_.processes = 1;
  Start();
  int killed = 0;
  const auto kill_all = [&](uint64_t /*triangles*/, uint64_t /*vertices*/) {
    for (const pid_t pid : Running()) killed += kill(pid, SIGKILL) == 0 ? 1 : 0;
    return absl::OkStatus();
  };
  const absl::Status status = Decode(*pool_, Large(), {}, kill_all).Get().status();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted) << status;
  EXPECT_EQ(ReasonOf(status), "DECODER_KILLED");
  EXPECT_TRUE(RetryDelayOf(status));
  EXPECT_EQ(killed, 5);
}

TEST_F(DecoderPoolTest, AnIdleProcessMayBeKilled) {
  Start();
  for (int n = 0; n < 3; ++n) {
    for (const pid_t pid : Running()) kill(pid, n == 1 ? SIGTERM : SIGKILL);
    ExpectSame(Decode(*pool_, Small()).Get(), Small());
  }
}

TEST_F(DecoderPoolTest, AMeshThatTwoProcessesCrashOnIsBad) {
  options_.processes = 1;
  for (const int crashes : {1, 2}) {
    Start();
    int crashed = 0;
    const auto crash = [&](uint64_t /*triangles*/, uint64_t /*vertices*/) {
      if (crashed < crashes) crashed += kill(Running().at(0), SIGSEGV) == 0 ? 1 : 0;
      return absl::OkStatus();
    };
    const auto result = Decode(*pool_, Large(), {}, crash).Get();
    if (crashes == 1) {
      ExpectSame(result, Large());
    } else {
      ExpectSameError(result.status(), BadMesh("the decoder crashed on it"));
    }
    ExpectSame(Decode(*pool_, Small()).Get(), Small());
    EXPECT_EQ(pool_->facts().crashes, crashes);
    pool_.reset();
  }
}

TEST_F(DecoderPoolTest, ADecodeEndsAtItsMemoryLimit) {
  if (kUnderSanitizer) GTEST_SKIP() << "there is no limit of memory under a sanitizer";
  options_.memory = 16 << 20;
  Start();
  const absl::Status status = Decode(*pool_, Large()).Get().status();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted) << status;
  EXPECT_EQ(status.message(), absl::StrCat("mesh: decoding takes more than ", options_.memory, " bytes of memory"));
  EXPECT_EQ(CauseOf(status)->reason, "OUT_OF_MEMORY");
  EXPECT_EQ(CauseOf(status)->limit, absl::StrCat(options_.memory));
  ExpectSame(Decode(*pool_, Small()).Get(), Small());
  EXPECT_EQ(pool_->facts().killed_for_memory, 1);
}

TEST_F(DecoderPoolTest, TellsWhatMemoryItsProcessesHold) {
  Start();
  ExpectSame(Decode(*pool_, Small()).Get(), Small());
  const double idle = pool_->facts().memory_bytes;
  EXPECT_GT(idle, 100'000);
  double at_work = 0;
  const auto look = [&](uint64_t /*triangles*/, uint64_t /*vertices*/) {
    at_work = pool_->facts().memory_bytes;
    return absl::OkStatus();
  };
  ExpectSame(Decode(*pool_, Large(), {}, look).Get(), Large());
  EXPECT_GT(at_work, idle + static_cast<double>(Large().size()));
  EXPECT_EQ(pool_->facts().most_memory_bytes,
            static_cast<double>(options_.memory) * static_cast<double>(options_.processes));
}

TEST_F(DecoderPoolTest, AMeshThatThereIsNoMemoryForIsRefusedBeforeItTakesAny) {
  options_.processes = 1;
  Start();
  uint64_t asked_for = 0;
  const auto refuse = [&](uint64_t triangles, uint64_t /*vertices*/) {
    asked_for = triangles;
    return absl::ResourceExhaustedError("no");
  };
  EXPECT_EQ(Decode(*pool_, Large(), {}, refuse).Get().status(), absl::ResourceExhaustedError("no"));
  EXPECT_EQ(asked_for, DecodeDraco(Large(), {})->mesh.triangles.size());
  ExpectSame(Decode(*pool_, Small()).Get(), Small());
}

TEST_F(DecoderPoolTest, ADecodeEndsAtItsCpuLimit) {
  options_.cpu_time = absl::Milliseconds(20);
  options_.processes = 1;
  Start();
  const absl::Status status = Decode(*pool_, Large()).Get().status();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted) << status;
  EXPECT_EQ(status.message(), "mesh: decoding takes more than 0.02 s");
  EXPECT_EQ(CauseOf(status)->reason, "DECODER_TIME");
  EXPECT_EQ(CauseOf(status)->limit, "0.02");
  EXPECT_FALSE(RetryDelayOf(status));
  EXPECT_EQ(pool_->facts().killed_for_time, 1);
  // It is the limit of one mesh: many may take more together.
  for (int n = 0; n < 100; ++n) ExpectSame(Decode(*pool_, Small()).Get(), Small());
  EXPECT_EQ(pool_->facts().killed_for_time, 1);
}

TEST_F(DecoderPoolTest, AMeshWhoseProcessDoesNothingGetsAnother) {
  options_.cpu_time = absl::Milliseconds(kUnderSanitizer ? 1000 : 300);  // a tenth of the real time of each process
  StartStopped();
  LogLines lines;
  ExpectSame(Decode(*pool_, Small()).Get(), Small());
  EXPECT_THAT(lines.End(), ContainsRegex("event=decoder_too_slow pid=[0-9]+ bytes=[0-9]+ request_id=id-7\n"));
  EXPECT_EQ(pool_->facts().killed_for_time, 1);
  EXPECT_EQ(pool_->facts().crashes, 0);
}

// 61 bytes that made Draco 1.5.5 take 20 GB: google/draco#1169.
TEST_F(DecoderPoolTest, ASmallFileThatAsksForGigabytesEndsSoonAndGetsNone) {
  if (kUnderSanitizer) GTEST_SKIP() << "there is no limit of memory under a sanitizer";
  options_.processes = 1;
  Start();
  std::ifstream file(LATVOX_RESERVE_BOMB, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(file), {});
  ASSERT_EQ(bytes.size(), 61);
  const absl::Time began = absl::Now();
  const absl::Status status = Decode(*pool_, bytes).Get().status();
  EXPECT_LT(absl::Now() - began, absl::Seconds(1));
  EXPECT_TRUE(absl::IsInvalidArgument(status) || absl::IsResourceExhausted(status)) << status;
}

TEST_F(DecoderPoolTest, OnDemandTheFirstMeshStartsTheProcesses) {
  options_.on_demand = true;
  auto pool = DecoderPool::Create(options_);
  ASSERT_TRUE(pool.ok()) << pool.status();
  EXPECT_TRUE(Children().empty());
  ExpectSame(Decode(**pool, Small()).Get(), Small());
  EXPECT_TRUE(Eventually([&] { return static_cast<int>(Running().size()) == options_.processes; }));
}

TEST_F(DecoderPoolTest, NoProcessIsLeft) {
  Start();
  ASSERT_EQ(Children().size(), 2);
  Decode decode(*pool_, Large());
  pool_.reset();
  EXPECT_TRUE(decode.over());
  EXPECT_TRUE(Children().empty());
}

}  // namespace
}  // namespace latvox
