// A pool of decoder processes for its tests, and what its decodes are held against.
#ifndef LATVOX_TESTS_UNIT_SERVER_DECODE_DECODER_POOL_H_
#define LATVOX_TESTS_UNIT_SERVER_DECODE_DECODER_POOL_H_

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/types.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <future>
#include <iterator>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "server/base/errors.h"
#include "server/decode/decoder_pool.h"
#include "server/decode/draco_decoder.h"
#include "tests/unit/server/decoders.h"
#include "tests/unit/server/meshes.h"

namespace latvox {

// Under a sanitizer, processes of the lowest priority (see StartStopped) take their time on a busy machine.
inline constexpr auto kPatience = std::chrono::seconds(kUnderSanitizer ? 200 : 30);

inline bool Eventually(const std::function<bool()>& condition) {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

// This process's children, the oldest first.
inline std::vector<pid_t> Children() {
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

inline void ExpectSame(const absl::StatusOr<DecodedMesh>& result, const std::string& bytes) {
  const auto expected = DecodeDraco(bytes, {});
  ASSERT_TRUE(result.ok()) << result.status();
  EXPECT_TRUE(result->mesh.vertices == expected->mesh.vertices);
  EXPECT_TRUE(result->mesh.triangles == expected->mesh.triangles);
  EXPECT_EQ(result->quantization_bits, expected->quantization_bits);
}

// Code, message and cause; the bytes of the cause may come in any order.
inline void ExpectSameError(const absl::Status& status, const absl::Status& expected) {
  EXPECT_EQ(status.code(), expected.code());
  EXPECT_EQ(status.message(), expected.message());
  EXPECT_TRUE(CauseOf(status) == CauseOf(expected)) << status;
}

inline const std::string& Small() {
  static const auto& bytes = *new std::string(EncodeDraco(Sphere(20), {}));
  return bytes;
}

// Takes some 100 MB and 0.1 s to decode, and more than a socket holds to send.
inline const std::string& Large() {
  static const auto& bytes = *new std::string(EncodeDraco(Sphere(500), {.quantization_bits = 0}));
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

  // Processes that are ready: they are confined, or, in a build with a sanitizer, have done the rest of it.
  static std::vector<pid_t> Running() {
    const char* const ready = kUnderSanitizer ? "NoNewPrivs:\t1" : "Seccomp:\t2";
    std::vector<pid_t> pids = Children();
    std::erase_if(pids, [ready](pid_t pid) {
      std::ifstream file(absl::StrCat("/proc/", pid, "/status"));
      const std::string status(std::istreambuf_iterator<char>(file), {});
      return status.find(ready) == std::string::npos || status.find("State:\tZ") != std::string::npos;
    });
    return pids;
  }

  // Starts a pool of one process, which does nothing. The processes that replace it have the lowest priority, as the
  // pool's thread has, so that they can be stopped before they have decoded anything.
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

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_SERVER_DECODE_DECODER_POOL_H_
