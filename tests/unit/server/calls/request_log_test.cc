// The log's line for a request.
#include "server/calls/request_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "server/base/errors.h"
#include "tests/unit/server/log_lines.h"

namespace latvox {
namespace {

using ::testing::HasSubstr;

RequestRecord Record(const std::string& method, const absl::Status& status = absl::OkStatus()) {
  RequestRecord record;
  record.origin.method = method;
  record.origin.request_id = "id-7";
  record.status = status;
  return record;
}

std::string LineOf(const RequestRecord& record, LogLevel level = LogLevel::kInfo) {
  LogLines lines(level);
  LogRequest(record);
  return lines.End();
}

TEST(RequestLog, HasTheCountsAndTimesOfAVoxelization) {
  RequestRecord record = Record("Voxelize");
  record.lattice = "bcc";
  record.work = ComputationFacts{.triangles = 8,
                                 .voxels = 9,
                                 .bricks = 1,
                                 .reserved_bytes = 7,
                                 .estimated_ms = 5,
                                 .cpu_ms = 6,
                                 .decode_ms = 2,
                                 .voxelize_ms = 3};
  record.upload_ms = 1;
  record.queue_ms = 0.5;
  EXPECT_THAT(LineOf(record), HasSubstr(" code=OK lattice=bcc k=0 triangles=8 voxels=9 bricks=1 "
                                        "reserved_bytes=7 bytes_in=0 bytes_out=0 "
                                        "upload_ms=1.000 queue_ms=0.500 decode_ms=2.000 voxelize_ms=3.000 "
                                        "stream_ms=0.000 estimated_ms=5.000 cpu_ms=6.000 total_ms=0.000\n"));
}

TEST(RequestLog, HasOfAnUploadWhatThereIsOfIt) {
  RequestRecord record = Record("PutMesh");
  record.bytes_in = 1000;
  record.upload_ms = 5;
  record.queue_ms = 1;
  record.total_ms = 7;
  EXPECT_THAT(LineOf(record), HasSubstr("request_id=id-7 method=PutMesh peer=\"\" code=OK bytes_in=1000 bytes_out=0 "
                                        "upload_ms=5.000 queue_ms=1.000 total_ms=7.000\n"));
}

TEST(RequestLog, NamesTheReasonOfAnError) {
  const std::string line = LineOf(Record("Voxelize", LimitExceeded("mesh_bytes", 9, 8)));
  EXPECT_THAT(line, HasSubstr("level=info "));
  EXPECT_THAT(line, HasSubstr(" code=RESOURCE_EXHAUSTED bytes_in=0 bytes_out=0 total_ms=0.000 reason=LIMIT_EXCEEDED "
                              "error=\"mesh_bytes 9 exceeds 8\"\n"));
}

TEST(RequestLog, HasADefectAtLevelErrorByTheCodeThatTheClientGets) {
  const std::string line = LineOf(Record("Voxelize", absl::UnknownError("oops")), LogLevel::kError);
  EXPECT_THAT(line, HasSubstr("level=error "));
  EXPECT_THAT(line, HasSubstr(" code=INTERNAL "));
}

}  // namespace
}  // namespace latvox
