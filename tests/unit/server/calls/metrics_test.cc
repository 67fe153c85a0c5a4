// The metrics, and the way in which Prometheus gets them.
#include "server/calls/metrics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "server/base/errors.h"
#include "server/listen/metrics_server.h"
#include "tests/unit/server/http.h"

namespace latvox {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

RequestRecord Voxelized() {
  RequestRecord record;
  record.origin.method = "Voxelize";
  record.work =
      ComputationFacts{.triangles = 8, .voxels = 100, .bricks = 3, .decode_ms = 2, .voxelize_ms = 20, .stream_ms = 0};
  record.bytes_in = 1000;
  record.bytes_out = 300;
  record.total_ms = 40;
  record.upload_ms = 5;
  return record;
}

TEST(Metrics, CountACallOnceInEachFamilyThatItBelongsTo) {
  Metrics metrics;
  metrics.Record(Voxelized());
  metrics.Record(Voxelized());
  const std::string text = metrics.Text();
  for (const char* line :
       {"latvox_requests_total{code=\"OK\",method=\"Voxelize\"} 2\n",
        "latvox_received_bytes_total{method=\"Voxelize\"} 2000\n", "latvox_sent_bytes_total{method=\"Voxelize\"} 600\n",
        "latvox_triangles_total 16\n", "latvox_voxels_total 200\n",
        "latvox_request_duration_seconds_sum{method=\"Voxelize\"} 0.08\n",
        "latvox_request_duration_seconds_bucket{method=\"Voxelize\",le=\"0.025\"} 0\n",
        "latvox_request_duration_seconds_bucket{method=\"Voxelize\",le=\"0.05\"} 2\n",
        "latvox_stage_duration_seconds_count{stage=\"upload\"} 2\n",
        "latvox_stage_duration_seconds_sum{stage=\"decode\"} 0.004\n",
        "latvox_stage_duration_seconds_sum{stage=\"voxelize\"} 0.04\n",
        "latvox_stage_duration_seconds_count{stage=\"stream\"} 2\n"}) {
    EXPECT_THAT(text, HasSubstr(line));
  }
  EXPECT_THAT(text, HasSubstr("latvox_stage_duration_seconds_count{stage=\"queue\"} 0\n"));
  EXPECT_THAT(text, Not(ContainsRegex("latvox_rejections_total\\{[^\n]*\\} [1-9]")));
}

TEST(Metrics, AreThereFromTheStartForEveryMethodCodeReasonAndStage) {
  const std::string text = Metrics().Text();
  for (const char* method :
       {"Voxelize", "VoxelizeStored", "VoxelizeSmall", "PutMesh", "UploadMesh", "Pixelize", "GetLimits"}) {
    for (const absl::StatusCode code : kCodes) {
      EXPECT_THAT(text, HasSubstr(absl::StrCat("latvox_requests_total{code=\"", absl::StatusCodeToString(code),
                                               "\",method=\"", method, "\"} 0\n")));
    }
    for (const char* name : {"received_bytes_total", "sent_bytes_total", "request_duration_seconds_count"}) {
      EXPECT_THAT(text, HasSubstr(absl::StrCat("latvox_", name, "{method=\"", method, "\"} 0\n")));
    }
  }
  for (const absl::string_view reason : kReasons) {
    if (reason == kMeshNotFound) continue;
    EXPECT_THAT(text, HasSubstr(absl::StrCat("latvox_rejections_total{reason=\"", reason, "\"} 0\n")));
  }
  EXPECT_THAT(text, HasSubstr("latvox_rejections_total{reason=\"UNAVAILABLE\"} 0\n"));
  for (const char* stage : {"upload", "queue", "decode", "voxelize", "stream", "pixelize"}) {
    EXPECT_THAT(text, HasSubstr(absl::StrCat("latvox_stage_duration_seconds_count{stage=\"", stage, "\"} 0\n")));
  }
}

TEST(Metrics, CountADefectAsTheInternalThatTheClientGets) {
  Metrics metrics;
  RequestRecord record;
  record.origin.method = "Voxelize";
  for (const absl::StatusCode code : {absl::StatusCode::kInternal, absl::StatusCode::kUnknown}) {
    record.status = absl::Status(code, "a defect");
    metrics.Record(record);
  }
  EXPECT_THAT(metrics.Text(), HasSubstr("latvox_requests_total{code=\"INTERNAL\",method=\"Voxelize\"} 2\n"));
}

TEST(Metrics, CountRefusalsByReasonAndLeaveTheirDurationsOut) {
  Metrics metrics;
  RequestRecord record;
  record.origin.method = "Voxelize";
  record.status = LimitExceeded("triangles", 9, 8);
  metrics.Record(record);
  record.status = absl::InvalidArgumentError("without a cause");
  metrics.Record(record);
  record.status = absl::CancelledError("the client cancelled the call");
  metrics.Record(record);
  record.status = MakeError(absl::StatusCode::kNotFound, "not kept", {kMeshNotFound, "", "", ""});
  metrics.Record(record);
  record.status = MakeError(absl::StatusCode::kUnavailable, "stalled", {"CLIENT_STALLED", "", "", ""});
  metrics.Record(record);
  const std::string text = metrics.Text();
  EXPECT_THAT(text, HasSubstr("latvox_requests_total{code=\"RESOURCE_EXHAUSTED\",method=\"Voxelize\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("latvox_requests_total{code=\"CANCELLED\",method=\"Voxelize\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("latvox_rejections_total{reason=\"LIMIT_EXCEEDED\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("latvox_rejections_total{reason=\"INVALID_ARGUMENT\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("latvox_rejections_total{reason=\"CLIENT_STALLED\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("latvox_requests_total{code=\"NOT_FOUND\",method=\"Voxelize\"} 1\n"));
  EXPECT_THAT(text, Not(HasSubstr("reason=\"MESH_NOT_FOUND\"")));
  EXPECT_THAT(text, Not(HasSubstr("reason=\"CANCELLED\"")));
  EXPECT_THAT(text, HasSubstr("latvox_request_duration_seconds_count{method=\"Voxelize\"} 0\n"));
  EXPECT_THAT(text, Not(ContainsRegex("stage_duration_seconds_count\\{[^\n]*\\} [1-9]")));
}

TEST(Metrics, ReadWhatOthersCountWhenTheyAreAsked) {
  Metrics metrics;
  double queued = 1;
  metrics.AddGauge("latvox_test_queued", "Waiting.", [&] { return queued; });
  metrics.AddCounter("latvox_test_restarts_total", "Ends.", [] { return 3; }, {{"pool", "a"}});
  metrics.AddCounter("latvox_test_restarts_total", "Ends.", [] { return 4; }, {{"pool", "b"}});
  queued = 7;
  const std::string text = metrics.Text();
  EXPECT_THAT(text,
              HasSubstr("# HELP latvox_test_queued Waiting.\n# TYPE latvox_test_queued gauge\nlatvox_test_queued 7\n"));
  EXPECT_THAT(text, HasSubstr("# TYPE latvox_test_restarts_total counter\n"
                              "latvox_test_restarts_total{pool=\"a\"} 3\nlatvox_test_restarts_total{pool=\"b\"} 4\n"));
}

double ValueOf(const std::string& text, const std::string& name) {
  const size_t at = text.find("\n" + name + " ");
  double value = -1;
  if (at == std::string::npos) return value;
  const size_t begin = at + name.size() + 2;
  EXPECT_TRUE(absl::SimpleAtod(text.substr(begin, text.find('\n', begin) - begin), &value));
  return value;
}

TEST(Metrics, TellOfTheProcessWhatTheKernelCounts) {
  Metrics metrics;
  auto much = std::make_unique<std::vector<char>>(64 << 20, 'x');
  const double before = ValueOf(metrics.Text(), "process_resident_memory_bytes");
  EXPECT_GT(before, 64 << 20);
  much.reset();
  EXPECT_LT(ValueOf(metrics.Text(), "process_resident_memory_bytes"), before - (60 << 20));
  const double age = static_cast<double>(time(nullptr)) - ValueOf(metrics.Text(), "process_start_time_seconds");
  EXPECT_GE(age, -2);
  EXPECT_LT(age, 600);
  const double files = ValueOf(metrics.Text(), "process_open_fds");
  const int one_more = dup(0);
  EXPECT_EQ(ValueOf(metrics.Text(), "process_open_fds"), files + 1);
  close(one_more);
  EXPECT_EQ(ValueOf(metrics.Text(), "process_threads"), 1);
  EXPECT_GT(ValueOf(metrics.Text(), "process_cpu_seconds_total"), 0);
}

TEST(MetricsServer, ServesThemUnderOnePathAndNamesAnAddressThatItCannotHave) {
  Metrics metrics;
  metrics.Record(Voxelized());
  const auto server = MetricsServer::Start("127.0.0.1:0", metrics);
  ASSERT_TRUE(server.ok()) << server.status();
  const std::string address = (*server)->address();
  EXPECT_THAT(Fetch(address, "GET /metrics HTTP/1.1\r\nHost: x\r\n\r\n"), HasSubstr("latvox_voxels_total 100\n"));
  EXPECT_THAT(Fetch(address, "GET /etc/passwd HTTP/1.1\r\nHost: x\r\n\r\n"), HasSubstr("404"));
  for (const std::string& bad : {address, std::string("nonsense"), std::string("203.0.113.1:1")}) {
    const auto other = MetricsServer::Start(bad, metrics);
    EXPECT_EQ(other.status().code(), absl::StatusCode::kUnavailable) << bad;
    EXPECT_THAT(std::string(other.status().message()), HasSubstr(bad));
  }
}

}  // namespace
}  // namespace latvox
