// The guard's judgment of a connection's bytes.
#include "server/guard/frame_guard.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>

#include "tests/unit/server/guard/frames.h"

namespace latvox {
namespace {

using namespace http2;  // NOLINT: the words of every line here

struct Verdict {
  std::optional<Offense> offense;
  FrameWork work;
};

Verdict Judge(const std::string& bytes, size_t piece = SIZE_MAX) {
  FrameGuard guard;
  Verdict verdict;
  for (size_t at = 0; at < bytes.size() && !verdict.offense; at += std::min(piece, bytes.size() - at)) {
    verdict.offense = guard.Receive(absl::string_view(bytes).substr(at, piece), verdict.work);
  }
  return verdict;
}

std::string Start() { return Preface() + Acknowledgment(); }

TEST(FrameGuard, LetsCallsPassInAnyPieces) {
  const std::string call = Start() + Call(1) + Frame(kData, 1, 1, std::string(70'000, 'x')) +
                           Frame(kHeaders, 0, 3, Field(":method", "POST")) + Frame(kContinuation, 0, 3, "") +
                           Frame(kContinuation, kEndHeaders, 3, Field("authorization", std::string(8000, 't'))) +
                           Frame(kHeaders, kEndHeaders | kPriority, 5, std::string(5, '\0') + Field("a", "b"));
  for (const size_t piece : {size_t{1}, size_t{2}, size_t{7}, size_t{9}, size_t{4096}, SIZE_MAX}) {
    EXPECT_EQ(Judge(call, piece).offense, std::nullopt) << piece;
  }
}

TEST(FrameGuard, RefusesWhatIsNotHttp2) {
  EXPECT_EQ(Judge("GET / HTTP/1.1\r\n").offense, Offense::kPreface);
  EXPECT_EQ(Judge("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\r", 1).offense, Offense::kPreface);
}

TEST(FrameGuard, RefusesAnUnfinishedValueAtOnce) {
  const std::string huge = {'\0', '\1', 'a'};
  for (const size_t piece : {size_t{1}, SIZE_MAX}) {
    EXPECT_EQ(Judge(Start() + Frame(kHeaders, 0, 1, huge + Integer(64 << 20) + std::string(100, 'y')), piece).offense,
              Offense::kHeaderBlock);
  }
}

TEST(FrameGuard, BoundsABlockByItsFrames) {
  std::string block = Frame(kHeaders, 0, 1, Field("a", std::string(16'000, 'y')));
  EXPECT_EQ(Judge(Start() + block).offense, std::nullopt);
  block += Frame(kContinuation, 0, 1, Field("b", std::string(16'000, 'y')));
  EXPECT_EQ(Judge(Start() + block).offense, std::nullopt);
  EXPECT_EQ(Judge(Start() + block + BigEndian(1000, 3) + BigEndian(kContinuation, 1) + BigEndian(0, 5)).offense,
            Offense::kHeaderBlock);
  EXPECT_EQ(Judge(Start() + BigEndian(kMostHeaderBytes + 1, 3) + BigEndian(kHeaders, 1) + BigEndian(0, 5)).offense,
            Offense::kHeaderBlock);
}

// A field of 4000 bytes enters the table. Each further byte of the block is that field again.
TEST(FrameGuard, BoundsABlockByItsFields) {
  const std::string entry = Field("k", std::string(4000, 'v'), "\x40");
  EXPECT_EQ(Judge(Start() + Frame(kHeaders, kEndHeaders, 1, entry + std::string(7, '\xbe'))).offense, std::nullopt);
  EXPECT_EQ(Judge(Start() + Frame(kHeaders, kEndHeaders, 1, entry + std::string(8, '\xbe'))).offense,
            Offense::kHeaderBlock);
  const std::string method(kMostHeaderFields, '\x82');  // :method GET, of the standard's own table
  EXPECT_EQ(Judge(Start() + Frame(kHeaders, kEndHeaders, 1, method)).offense, std::nullopt);
  EXPECT_EQ(Judge(Start() + Frame(kHeaders, kEndHeaders, 1, method + '\x82')).offense, Offense::kHeaderBlock);
}

TEST(FrameGuard, RefusesWhatGrpcReadsDifferently) {
  EXPECT_EQ(Judge(Start() + Frame(kHeaders, kEndHeaders | kPadded, 1, std::string(1, '\0'))).offense,
            Offense::kHeaderBlock);
  EXPECT_EQ(Judge(Start() + Frame(kHeaders, kEndHeaders, 1, "\x7f")).offense, Offense::kHeaderBlock);
  EXPECT_EQ(Judge(Start() + Frame(kHeaders, kEndHeaders | kPriority, 1, "abc")).offense, Offense::kHeaderBlock);
  EXPECT_EQ(Judge(Start() + Frame(kHeaders, 0, 1, "") + Frame(kPing, 0, 0, "12345678")).offense, Offense::kHeaderBlock);
  EXPECT_EQ(Judge(Start() + Frame(kContinuation, kEndHeaders, 1, "")).offense, Offense::kHeaderBlock);
}

TEST(FrameGuard, BoundsStreamsUntilSettingsAreAcknowledged) {
  std::string calls;
  for (uint32_t n = 0; n < kMostStreams; ++n) calls += Call(2 * n + 1);
  EXPECT_EQ(Judge(Preface() + calls).offense, std::nullopt);
  EXPECT_EQ(Judge(Preface() + calls + Call(9999)).offense, Offense::kNoSettings);
  EXPECT_EQ(Judge(Start() + calls + Call(9999)).offense, std::nullopt);
}

TEST(FrameGuard, CountsWorkByKind) {
  const auto work = [](const std::string& frame) { return Judge(Start() + frame).work.all - Judge(Start()).work.all; };
  EXPECT_EQ(work(Frame(kData, 0, 1, std::string(16'000, 'x'))), 0);
  EXPECT_GT(work(Frame(kData, 0, 1, "")), 0);
  EXPECT_GT(work(Frame(kWindowUpdate, 0, 0, BigEndian(1, 4))), 0);
  EXPECT_GT(work(Frame(kPing, 0, 0, "12345678")), work(Frame(kWindowUpdate, 0, 0, BigEndian(1, 4))));
  EXPECT_GT(work(Frame(kReset, 0, 1, BigEndian(8, 4))), work(Frame(kPing, 0, 0, "12345678")));
}

// gRPC parses an unfinished block again with each read.
TEST(FrameGuard, CountsTheReadsOfABlock) {
  const std::string block = Start() + Frame(kHeaders, 0, 1, Field("a", std::string(16'000, 'y')));
  EXPECT_GT(Judge(block, 1).work.all, 100 * Judge(block, 4096).work.all);
}

// After the first calls, each waits for the answer of an earlier one.
TEST(FrameGuard, KnowsCallsThatWaitForAnswers) {
  std::string calls = Start();
  for (uint32_t n = 0; n < kMostStreams; ++n) calls += Call(2 * n + 1);
  EXPECT_GT(Judge(calls).work.unasked, Judge(Start() + Call(1)).work.unasked);
  EXPECT_EQ(Judge(calls + Call(9999)).work.unasked, Judge(calls).work.unasked);
  EXPECT_GT(Judge(calls + Call(9999)).work.all, Judge(calls).work.all);
}

}  // namespace
}  // namespace latvox
