// Programs that are no decoders, in the place of latvoxd: the pool survives what they say and do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/base/errors.h"
#include "server/decode/decoder_pool.h"
#include "tests/unit/server/decode/decoder_pool.h"
#include "tests/unit/temporary_directory.h"

namespace latvox {
namespace {

using ::testing::HasSubstr;

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
  const double small = (kUnderSanitizer ? 1 : 0.1) + 1e-6 * static_cast<double>(Small().size());
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
