// Meshes decoded in processes of their own, and all that can become of these.
#include "server/decode/decoder_pool.h"

#include <dirent.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <future>
#include <iterator>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "server/base/errors.h"
#include "server/decode/draco_decoder.h"
#include "tests/unit/server/decoders.h"
#include "tests/unit/server/log_lines.h"
#include "tests/unit/server/meshes.h"
#include "tests/unit/temporary_directory.h"

namespace latvox {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;

// With AddressSanitizer, processes of the lowest priority (see StartStopped) take their time on a busy machine.
constexpr auto kPatience = std::chrono::seconds(kAddressSanitizer ? 200 : 30);
constexpr absl::Duration kAtOnce = absl::Milliseconds(50);

bool Eventually(const std::function<bool()>& condition) {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

// This process's children, the oldest first.
std::vector<pid_t> Children() {
  std::vector<pid_t> pids;
  for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream file(thread.path() / "children");
    std::copy(std::istream_iterator<pid_t>(file), {}, std::back_inserter(pids));
  }
  std::sort(pids.begin(), pids.end());
  return pids;
}

// A decode whose end can be waited for.
class Decode {
 public:
  Decode(DecoderPool& pool, const std::string& bytes, const Limits& limits = {}, MeshDecoder::Reserve reserve = {},
         const FieldList& wanted = {}, const std::string& client = "")
      : result_(promise_.get_future()),
        decoding_(
            pool.Start({absl::Cord(bytes), wanted, "id-7", client}, limits, std::move(reserve), [this](auto mesh) {
              ended_ = absl::Now();
              promise_.set_value(std::move(mesh));
            })) {}

  void Cancel() { decoding_->Cancel(); }
  bool over() const { return result_.wait_for(std::chrono::seconds(0)) == std::future_status::ready; }
  absl::StatusOr<DecodedMesh> Get() {
    if (result_.wait_for(kPatience) != std::future_status::ready) return absl::UnknownError("the decode does not end");
    return result_.get();
  }
  absl::Time ended() const { return ended_; }

 private:
  absl::Time ended_;
  std::promise<absl::StatusOr<DecodedMesh>> promise_;
  std::future<absl::StatusOr<DecodedMesh>> result_;
  std::shared_ptr<MeshDecoder::Decoding> decoding_;
};

void ExpectSame(const absl::StatusOr<DecodedMesh>& result, const std::string& bytes) {
  const auto expected = DecodeDraco(bytes, {});
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_TRUE(result->mesh.vertices == expected->mesh.vertices);
  EXPECT_TRUE(result->mesh.triangles == expected->mesh.triangles);
  EXPECT_EQ(result->quantization_bits, expected->quantization_bits);
}

// Code, message and cause; the bytes of the cause may come in any order.
void ExpectSameError(const absl::Status& status, const absl::Status& expected) {
  EXPECT_EQ(status.code(), expected.code());
  EXPECT_EQ(status.message(), expected.message());
  EXPECT_TRUE(CauseOf(status) == CauseOf(expected)) << status;
}

const std::string& Small() {
  static const auto& bytes = *new std::string(EncodeDraco(Sphere(20), {}));
  return bytes;
}

// Takes some 100 MB and 0.1 s to decode, and more than a socket holds to send.
const std::string& Large() {
  static const auto& bytes = *new std::string(EncodeDraco(Sphere(500), {.quantization_bits = 0}));
  return bytes;
}

// Half a million triangles in some kilobytes.
const std::string& Dense() {
  static const auto& bytes = *new std::string(EncodeDraco(FlatGrid(512), {.quantization_bits = 10, .speed = 0}));
  return bytes;
}

class DecoderPoolTest : public testing::Test {
 protected:
  void Start() {
    auto pool = DecoderPool::Create(options_);
    ASSERT_TRUE(pool.ok()) << pool.status();
    pool_ = *std::move(pool);
    // All of them run their program.
    ASSERT_TRUE(Eventually([&] { return static_cast<int>(Running().size()) == options_.processes; }));
  }

  // Processes that are ready: they are confined, or, in a build with AddressSanitizer, have done the rest of it.
  static std::vector<pid_t> Running() {
    const char* const ready = kAddressSanitizer ? "NoNewPrivs:\t1" : "Seccomp:\t2";
    std::vector<pid_t> pids = Children();
    std::erase_if(pids, [ready](pid_t pid) {
      std::ifstream file(absl::StrCat("/proc/", pid, "/status"));
      const std::string status(std::istreambuf_iterator<char>(file), {});
      return status.find(ready) == std::string::npos || status.find("State:\tZ") != std::string::npos;
    });
    return pids;
  }

  // A pool of one process, which does nothing.
  // Those that follow on it have the lowest priority, as the pool's thread has, so that they can be stopped before they
  // have decoded anything.
  pid_t StartStopped() {
    options_.processes = 1;
    const int priority = getpriority(PRIO_PROCESS, 0);  // this thread's, in spite of its name
    setpriority(PRIO_PROCESS, 0, 19);
    Start();
    setpriority(PRIO_PROCESS, 0, priority);
    const pid_t pid = Running().at(0);
    kill(pid, SIGSTOP);
    return pid;
  }

  DecoderOptions options_ = TestDecoders();
  std::unique_ptr<DecoderPool> pool_;
};

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
  Decode decode(*pool_, Large());
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  const absl::Time cancelled = absl::Now();
  decode.Cancel();
  EXPECT_EQ(decode.Get().status().code(), absl::StatusCode::kCancelled);
  EXPECT_LT(decode.ended() - cancelled, kAtOnce);
  decode.Cancel();  // once more does no harm
  ExpectSame(Decode(*pool_, Small()).Get(), Small());
  EXPECT_EQ(pool_->facts().restarts, 1);
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
  if (kAddressSanitizer) GTEST_SKIP() << "there is no limit of memory with AddressSanitizer";
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
  options_.cpu_time = absl::Milliseconds(kAddressSanitizer ? 1000 : 300);  // a tenth of the real time of each process
  StartStopped();
  LogLines lines;
  ExpectSame(Decode(*pool_, Small()).Get(), Small());
  EXPECT_THAT(lines.End(), ContainsRegex("event=decoder_too_slow pid=[0-9]+ bytes=[0-9]+ request_id=id-7\n"));
  EXPECT_EQ(pool_->facts().killed_for_time, 1);
  EXPECT_EQ(pool_->facts().crashes, 0);
}

// 61 bytes that made Draco 1.5.5 take 20 GB: google/draco#1169.
TEST_F(DecoderPoolTest, ASmallFileThatAsksForGigabytesEndsSoonAndGetsNone) {
  if (kAddressSanitizer) GTEST_SKIP() << "there is no limit of memory with AddressSanitizer";
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

TEST_F(DecoderPoolTest, NoProcessIsLeft) {
  Start();
  ASSERT_EQ(Children().size(), 2);
  Decode decode(*pool_, Large());
  pool_.reset();
  EXPECT_TRUE(decode.over());
  EXPECT_TRUE(Children().empty());
}

// A program of a test's own in the place of latvoxd.
class ForeignProgram : public DecoderPoolTest {
 protected:
  ~ForeignProgram() override { pool_.reset(); }

  void Write(const std::string& script) {
    options_.program = directory_ / "program";
    std::ofstream(options_.program) << "#!/bin/sh\n" << script;
    chmod(options_.program.c_str(), 0700);
  }

  // The program does not confine itself, as Start expects it.
  void Open() {
    auto pool = DecoderPool::Create(options_);
    ASSERT_TRUE(pool.ok()) << pool.status();
    pool_ = *std::move(pool);
  }

  TemporaryDirectory directory_;
};

TEST_F(ForeignProgram, ThatDoesNotStartIsNamed) {
  const auto expect = [&](const std::string& why) {
    const auto pool = DecoderPool::Create(options_);
    ASSERT_FALSE(pool.ok());
    EXPECT_EQ(pool.status().code(), absl::StatusCode::kUnavailable);
    EXPECT_THAT(std::string(pool.status().message()), HasSubstr(why));
  };
  options_.program = "/nonexistent/latvoxd";
  expect("/nonexistent/latvoxd: No such file or directory");
  Write("exit 3");
  expect("status 3");
  options_.program = "";
  EXPECT_EQ(DecoderPool::Create(options_).status().code(), absl::StatusCode::kInvalidArgument);
}

// ReadyFrame with its header, then an answer to whatever comes.
std::string Answering(const std::string& answer) {
  return "printf '\\0\\0\\0\\0\\010\\0\\0\\0\\0\\0\\0\\0\\0\\0\\0\\0' >&3\nhead -c 100 <&3 >/dev/null\n" + answer;
}

TEST_F(ForeignProgram, ThatTalksNonsenseIsKilledAndItsWordNotTaken) {
  const std::string nonsense[] = {
      "printf 'nonsense, and more of it' >&3\nsleep 60\n",  // a huge frame
      "printf '\\1\\0\\0\\0\\014\\0\\0\\0\\377\\377\\377\\377\\1\\0\\0\\0\\0\\0\\0\\0' >&3\nsleep 60\n",  // a huge mesh
      "printf '\\4\\0\\0\\0\\0\\0\\0\\0' >&3\nsleep 60\n",  // done, without a mesh
  };
  for (const std::string& answer : nonsense) {
    Write(Answering(answer));
    auto pool = DecoderPool::Create(options_);
    ASSERT_TRUE(pool.ok()) << pool.status();
    ExpectSameError(Decode(**pool, Small()).Get().status(), BadMesh("the decoder crashed on it"));
    EXPECT_EQ((*pool)->facts().crashes, 2);
  }
}

TEST_F(ForeignProgram, ThatDoesNothingIsReplacedOnce) {
  options_.cpu_time = absl::Milliseconds(20);
  Write(Answering("exec sleep 60\n"));
  Open();
  const absl::Status status = Decode(*pool_, Small()).Get().status();
  EXPECT_EQ(ReasonOf(status), "DECODER_TIME") << status;
  EXPECT_EQ(pool_->facts().killed_for_time, 2);
}

TEST_F(ForeignProgram, MayTakeTheCpuTimeThatTheMeshDeclares) {
  const double small = (kAddressSanitizer ? 1 : 0.1) + 1e-6 * static_cast<double>(Small().size());
  const std::pair<std::string, double> limits[] = {
      {"", small},
      // 100,000 triangles
      {"printf '\\7\\0\\0\\0\\020\\0\\0\\0\\240\\206\\1\\0\\0\\0\\0\\0\\0\\0\\0\\0\\0\\0\\0\\0' >&3\n", small + 0.5}};
  for (const auto& [declaration, seconds] : limits) {
    Write(Answering(declaration + "while :; do :; done\n"));
    Open();
    EXPECT_EQ(Decode(*pool_, Small()).Get().status().message(),
              absl::StrCat("mesh: decoding takes more than ", seconds, " s"));
  }
}

TEST_F(ForeignProgram, ThatDeclaresTwiceOrTooMuchIsKilled) {
  const std::string small = "printf '\7\0\0\0\020\0\0\0\1\0\0\0\0\0\0\0\1\0\0\0\0\0\0\0' >&3\n";
  const std::string huge = "printf '\7\0\0\0\020\0\0\0\0\0\0\0\0\0\0\1\1\0\0\0\0\0\0\0' >&3\n";
  for (const std::string& declarations : {small + small, huge}) {
    Write(Answering(declarations + "exec sleep 60\n"));
    Open();
    ExpectSameError(Decode(*pool_, Small()).Get().status(), BadMesh("the decoder crashed on it"));
  }
}

TEST_F(ForeignProgram, ThatIsGoneLaterFailsDecodesInTheEndAndIsTriedAgain) {
  Write(absl::StrCat("exec ", LATVOXD, " \"$@\"\n"));
  options_.processes = 1;
  auto pool = DecoderPool::Create(options_);
  ASSERT_TRUE(pool.ok()) << pool.status();
  std::filesystem::rename(options_.program, options_.program + "2");
  for (const pid_t pid : Children()) kill(pid, SIGKILL);
  const absl::Status status = Decode(**pool, Small()).Get().status();
  EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable) << status;
  EXPECT_TRUE(RetryDelayOf(status));
  std::filesystem::rename(options_.program + "2", options_.program);
  EXPECT_TRUE(Eventually([&] { return Decode(**pool, Small()).Get().ok(); }));
}

}  // namespace
}  // namespace latvox
