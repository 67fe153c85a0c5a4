// The command line tool: its messages and its end.
#include <gmock/gmock.h>
#include <signal.h>

#include <atomic>
#include <new>
#include <thread>

#include "absl/synchronization/notification.h"
#include "absl/time/clock.h"
#include "client/tool/cli/abandoned_work.h"
#include "client/tool/cli/exit_status.h"
#include "client/tool/cli/progress_bar.h"
#include "client/tool/cli/report.h"
#include "client/tool/cli/voxelize_command.h"
#include "latvox/error.h"
#include "tests/unit/client/files.h"

namespace latvox::client {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

TEST(Exit, EveryStatusCodeHasItsNumber) {
  using absl::StatusCode;
  const std::map<StatusCode, int> numbers = {
      {StatusCode::kOk, 0},          {StatusCode::kInvalidArgument, 3},   {StatusCode::kNotFound, 3},
      {StatusCode::kUnavailable, 4}, {StatusCode::kResourceExhausted, 5}, {StatusCode::kUnauthenticated, 5},
      {StatusCode::kCancelled, 6},   {StatusCode::kDeadlineExceeded, 6}};
  for (int code = 0; code <= 16; ++code) {
    const auto status_code = static_cast<StatusCode>(code);
    const auto found = numbers.find(status_code);
    EXPECT_EQ(static_cast<int>(ExitStatusOf(absl::Status(status_code, ""))), found == numbers.end() ? 1 : found->second)
        << code;
  }
}

TEST(Exit, TheLineNamesFieldAndLimitOnceAndIsOneLine) {
  absl::Status status = absl::ResourceExhaustedError("too many\njobs: 5");
  SetErrorDetails({"JOBS", "jobs", "5", "4", absl::Seconds(2)}, status);
  EXPECT_EQ(ErrorText(status), "too many jobs: 5 (limit 4) (try again in 2s)");
  // A damaged file's bytes, and a line that would go on in red.
  EXPECT_EQ(ErrorText(absl::InvalidArgumentError("a: no \xe9\x1b[31m\nb")), "a: no \\xe9\\x1b[31m b");
}

TEST(Report, JsonHasEveryKeyThatScriptsRelyOn) {
  VoxelizeReport report;
  report.summary.certificate.lattice = "bcc";
  const std::string plain = ToJson(report);
  for (const char* key :
       {"voxels",     "bricks",      "lattice",  "basis",  "origin",    "voxel_size",     "separability",
        "digest",     "certificate", "minimal",  "set",    "closed",    "snap_error_max", "verified",
        "timings_ms", "encode",      "upload",   "decode", "voxelize",  "stream",         "total",
        "bytes",      "sent",        "received", "mesh",   "triangles", "vertices"}) {
    EXPECT_THAT(plain, HasSubstr("\"" + std::string(key) + "\":"));
  }
  EXPECT_THAT(plain, HasSubstr("\"tunnels\": null"));
  EXPECT_THAT(plain, HasSubstr("\"redundant\": null"));
  report.summary.certificate.verified = true;
  EXPECT_THAT(ToJson(report), HasSubstr("\"tunnels\": 0"));
  report.outputs = {"not utf-8 \xFF.vdb"};
  EXPECT_THAT(ToJson(report), HasSubstr("not utf-8"));
}

TEST(Report, TellsOfABand) {
  VoxelizeReport report;
  EXPECT_THAT(ToJson(report), Not(HasSubstr("\"band\"")));
  report.summary.certificate.band = BandFacts{0.5};
  report.summary.certificate.fields = {{Field::kDistance, "0123"}};
  report.summary.certificate.signed_distance = true;
  EXPECT_THAT(ToJson(report),
              AllOf(HasSubstr("\"width\": 0.5"), HasSubstr("\"signed\": true"), HasSubstr("\"digest\": \"0123\"")));
  EXPECT_THAT(ToText(report),
              AllOf(HasSubstr("band of 0.5"), HasSubstr("each voxel carries distance; distances are negative inside")));
}

TEST(Report, TextClaimsNoSeparationThatIsNotCertain) {
  VoxelizeReport report;
  report.summary.certificate.algorithm = "incremental";
  report.summary.certificate.separability = 1;
  EXPECT_THAT(ToText(report), AllOf(HasSubstr("k = 1, incremental"), Not(HasSubstr("separating"))));
  report.summary.certificate.tunnel_free = true;
  EXPECT_THAT(ToText(report), AllOf(HasSubstr("1-separating"), Not(HasSubstr("minimal"))));
  report.summary.certificate.minimal = true;
  EXPECT_THAT(ToText(report), HasSubstr("1-separating, minimal"));
}

TEST(Progress, RatesAndTheTimeLeftAreToldOnceTheyMeanSomething) {
  EXPECT_EQ(CountText("bricks", 1000, absl::Milliseconds(100)), "1000 bricks");
  EXPECT_EQ(CountText("bricks", 1000, absl::Seconds(4)), "1000 bricks, 250/s");
  EXPECT_EQ(RemainingText(0.25, absl::Milliseconds(100)), "");
  EXPECT_EQ(RemainingText(0, absl::Seconds(4)), "");
  EXPECT_EQ(RemainingText(0.25, absl::Seconds(4)), ", 12s left");
  EXPECT_EQ(RemainingText(0.25, absl::Seconds(25)), ", 1m15s left");
  EXPECT_EQ(RemainingText(1, absl::Seconds(25)), ", 0 left");
}

TEST(Progress, TheBarShrinksFirstThenTheCountsThenTextsAreLeftOut) {
  const auto line = [](size_t columns) {
    const ProgressLine fit = FitProgress(columns, 0.12, "voxelizing", "bricks", 1736221, absl::Milliseconds(542569));
    return absl::StrCat(fit.cells, fit.text);
  };
  const char* const kWhole = "  12 %  voxelizing: 1736221 bricks, 3200/s, 1h6m19s left";
  EXPECT_EQ(line(120), absl::StrCat(30, kWhole));
  EXPECT_EQ(line(80), absl::StrCat(80 - 3 - strlen(kWhole), kWhole));
  EXPECT_EQ(line(60), "4  12 %  voxelizing: 1h6m19s left, 1.7M bricks, 3200/s");
  EXPECT_EQ(line(44), "9  12 %  voxelizing: 1h6m19s left");
  EXPECT_EQ(line(39), "4  12 %  voxelizing: 1h6m19s left");
  EXPECT_EQ(line(38), "29  12 %");
  EXPECT_EQ(line(10), "1  12 %");
  EXPECT_EQ(line(5), "0  ");
}

TEST(Progress, ShortCountsHaveThreeDigitsOrSo) {
  const std::vector<std::pair<uint64_t, const char*>> counts = {
      {0, "0"},        {9999, "9999"},    {10000, "10K"},      {12345, "12.3K"},
      {99999, "100K"}, {1736221, "1.7M"}, {8800000000, "8.8G"}};
  for (const auto& [count, text] : counts) EXPECT_EQ(ShortNumber(count), text);
}

TEST(Report, SaysHowAMeshWasFilled) {
  VoxelizeReport report;
  EXPECT_THAT(ToText(report), Not(HasSubstr("filled")));
  EXPECT_THAT(ToJson(report), Not(HasSubstr("unbalanced_lines")));
  report.summary.certificate.set = "interior";
  report.summary.certificate.solid = SolidFacts{"winding", 0};
  EXPECT_THAT(ToText(report),
              AllOf(HasSubstr("filled by winding, without the surface\n"), Not(HasSubstr("not filled"))));
  report.summary.certificate.solid->unbalanced_lines = 7;
  EXPECT_THAT(ToText(report), HasSubstr("not filled: 7 lattice lines"));
  EXPECT_THAT(ToJson(report), AllOf(HasSubstr("\"set\": \"interior\""), HasSubstr("\"rule\": \"winding\""),
                                    HasSubstr("\"unbalanced_lines\": 7")));
}

class Command : public FilesTest {};

TEST_F(Command, AServerThatCannotBeReachedLeavesNoFileAndKeepsOldOnes) {
  VoxelizeOptions options;
  options.mesh.paths = {Write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")};
  options.outputs = {Path("a.vdb"), Write("b.csv", "old")};
  options.request.resolution = 4;
  options.server.address = "unix:" + Path("nobody");
  const auto report = RunVoxelize(options, Cancellation());
  EXPECT_EQ(ExitStatusOf(report.status()), ExitStatus::kUnreachable);
  EXPECT_THAT(Names(), ElementsAre("b.csv", "m.obj"));
  EXPECT_EQ(Read("b.csv"), "old");
}

TEST_F(Command, ACancelledOneStopsBeforeTheServerIsNeeded) {
  VoxelizeOptions options;
  options.mesh.paths = {Write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")};
  options.outputs = {Path("a.vdb")};
  options.request.resolution = 4;
  options.server.address = "unix:" + Path("nobody");
  const Cancellation cancellation;
  cancellation.Cancel();
  EXPECT_EQ(ExitStatusOf(RunVoxelize(options, cancellation).status()), ExitStatus::kCancelled);
  EXPECT_THAT(Names(), ElementsAre("m.obj"));
}

TEST(AbandonedWork, IsNotWaitedForOnceCancelledOrLate) {
  const bool any_before = AnyAbandoned();  // by other tests
  EXPECT_EQ(DoAbandonably([] { return absl::StatusOr<int>(7); }, {}).value(), 7);
  const auto fail = []() -> absl::StatusOr<int> { throw std::bad_alloc(); };
  EXPECT_THROW(static_cast<void>(DoAbandonably(fail, {})), std::bad_alloc);
  EXPECT_EQ(AnyAbandoned(), any_before);
  static absl::Notification go_on;
  static std::atomic<int> begun, ended;
  struct AtEnd {
    ~AtEnd() { ++ended; }
  };
  const auto work = [] {
    thread_local AtEnd at_end;
    ++begun;
    go_on.WaitForNotification();
    return absl::StatusOr<const void*>(&at_end);
  };
  CallOptions late, cancelled;
  late.deadline = absl::Now() + absl::Milliseconds(300);
  EXPECT_EQ(DoAbandonably(work, late).status(), absl::DeadlineExceededError("the --timeout passed"));
  std::thread canceller([&] {
    while (begun < 2) absl::SleepFor(absl::Milliseconds(1));
    cancelled.cancellation.Cancel();
  });
  EXPECT_EQ(DoAbandonably(work, cancelled).status(), absl::CancelledError("cancelled"));
  canceller.join();
  EXPECT_TRUE(AnyAbandoned());
  // Work that is late or cancelled does not begin.
  EXPECT_EQ(DoAbandonably(work, late).status().code(), absl::StatusCode::kDeadlineExceeded);
  EXPECT_EQ(DoAbandonably(work, cancelled).status().code(), absl::StatusCode::kCancelled);
  EXPECT_EQ(begun, 2);
  go_on.Notify();
  while (ended < begun) absl::SleepFor(absl::Milliseconds(1));
}

// Imitates OpenSSL, which frees thread-local data also while the process ends.
TEST(AbandonedWork, HasLeftItsThreadOnceItIsWaitedFor) {
  static std::atomic<bool> ended;
  struct AtEnd {
    ~AtEnd() {
      absl::SleepFor(absl::Milliseconds(50));
      ended = true;
    }
  };
  const auto work = [] {
    thread_local AtEnd at_end;
    return absl::StatusOr<const void*>(&at_end);
  };
  EXPECT_TRUE(DoAbandonably(work, {}).ok());
  EXPECT_TRUE(ended);
}

}  // namespace
}  // namespace latvox::client
