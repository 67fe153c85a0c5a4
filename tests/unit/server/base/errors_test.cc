// Errors on their way to the wire: codes, causes, retry delays.
#include "server/base/errors.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/status_payload.h"
#include "latvox/v1/voxelizer.pb.h"
#include "tests/unit/server/error_details.h"

namespace latvox {
namespace {

TEST(ErrorTable, MapsEveryCodeToOneOfTheContracts) {
  using grpc::StatusCode;
  const std::vector<std::pair<absl::StatusCode, StatusCode>> table = {
      {absl::StatusCode::kOk, StatusCode::OK},
      {absl::StatusCode::kCancelled, StatusCode::CANCELLED},
      {absl::StatusCode::kUnknown, StatusCode::INTERNAL},
      {absl::StatusCode::kInvalidArgument, StatusCode::INVALID_ARGUMENT},
      {absl::StatusCode::kDeadlineExceeded, StatusCode::DEADLINE_EXCEEDED},
      {absl::StatusCode::kNotFound, StatusCode::NOT_FOUND},
      {absl::StatusCode::kAlreadyExists, StatusCode::INTERNAL},
      {absl::StatusCode::kPermissionDenied, StatusCode::INTERNAL},
      {absl::StatusCode::kResourceExhausted, StatusCode::RESOURCE_EXHAUSTED},
      {absl::StatusCode::kFailedPrecondition, StatusCode::INTERNAL},
      {absl::StatusCode::kAborted, StatusCode::INTERNAL},
      {absl::StatusCode::kOutOfRange, StatusCode::INTERNAL},
      {absl::StatusCode::kUnimplemented, StatusCode::INTERNAL},
      {absl::StatusCode::kInternal, StatusCode::INTERNAL},
      {absl::StatusCode::kUnavailable, StatusCode::UNAVAILABLE},
      {absl::StatusCode::kDataLoss, StatusCode::INTERNAL},
      {absl::StatusCode::kUnauthenticated, StatusCode::UNAUTHENTICATED},
  };
  for (const auto& [ours, wire] : table) {
    const grpc::Status status = ToGrpcStatus(absl::Status(ours, "message"));
    EXPECT_EQ(status.error_code(), wire) << ours;
    if (status.ok()) continue;
    EXPECT_EQ(status.error_message(), "message");
    EXPECT_EQ(DetailsOf(status).code(), wire);
    EXPECT_EQ(DetailsOf(status).message(), "message");
    EXPECT_EQ(ErrorInfoOf(status).domain(), "latvox");
    EXPECT_FALSE(ErrorInfoOf(status).reason().empty());
  }
}

TEST(ErrorTable, CarriesCauseAndRetryDelay) {
  const absl::Status status = WithRetry(LimitExceeded("mesh.triangles", 12, 10), absl::Milliseconds(1250));
  EXPECT_EQ(status.message(), "mesh.triangles 12 exceeds 10");
  EXPECT_EQ(RetryDelayOf(status), absl::Milliseconds(1250));
  const grpc::Status wire = ToGrpcStatus(status);
  const google::rpc::ErrorInfo info = ErrorInfoOf(wire);
  EXPECT_EQ(info.reason(), "LIMIT_EXCEEDED");
  EXPECT_EQ(info.metadata().at("field"), "mesh.triangles");
  EXPECT_EQ(info.metadata().at("value"), "12");
  EXPECT_EQ(info.metadata().at("limit"), "10");
  google::rpc::RetryInfo retry;
  ASSERT_EQ(DetailsOf(wire).details_size(), 2);
  ASSERT_TRUE(DetailsOf(wire).details(1).UnpackTo(&retry));
  EXPECT_EQ(retry.retry_delay().seconds(), 1);
  EXPECT_EQ(retry.retry_delay().nanos(), 250'000'000);
}

TEST(ErrorTable, NamesTheLimitThatGetLimitsTells) {
  const auto& limits = *v1::GetLimitsResponse::descriptor();
  const auto name = [](const absl::Status& status) {
    const auto metadata = ErrorInfoOf(ToGrpcStatus(status)).metadata();
    return metadata.contains("limit_name") ? metadata.at("limit_name") : "";
  };
  for (const char* field : {"mesh_bytes", "mesh.triangles", "mesh.vertices", "visited_points", "message_bytes",
                            "memory", "points", "crossings", "pixels"}) {
    const std::string limit_name = name(LimitExceeded(field, 2, 1));
    EXPECT_NE(limits.FindFieldByName(limit_name), nullptr) << field << ": " << limit_name;
  }
  EXPECT_EQ(name(LimitExceeded("mesh_bytes", 2, 1)), "max_mesh_bytes");
  EXPECT_EQ(name(LimitExceeded("mesh_bytes", 2, 1, "mesh_store_bytes")), "mesh_store_bytes");
  EXPECT_EQ(name(BadSpec("mesh_bytes 3 was declared", "mesh_bytes", "3", "2")), "");
}

TEST(ErrorTable, NamesWhatCoreHasUnderTheNamesOfTheRequest) {
  const RequestFields fields{"resolution", "band.voxels"};
  const auto cause = [&](const absl::Status& status) { return CauseOf(WithCauseOfCore(status, fields)).value(); };
  const auto error = [](const char* message) { return absl::InvalidArgumentError(message); };
  const absl::Status too_fine = WithValue(absl::ResourceExhaustedError("voxel_size: too fine"), 7, 6);
  EXPECT_EQ(cause(too_fine), (ErrorCause{"LIMIT_EXCEEDED", "resolution", "7", "6", "max_extent"}));
  EXPECT_EQ(cause(WithValue(error("voxel_size: at 1e-300, basis: underflows"), "1e-300")),
            (ErrorCause{"BAD_SPEC", "resolution", "1e-300", ""}));
  EXPECT_EQ(cause(WithValue(error("band: too wide"), 257, 256)), (ErrorCause{"BAD_SPEC", "band.voxels", "257", "256"}));
  EXPECT_EQ(cause(error("band: not together with solid")), (ErrorCause{"BAD_SPEC", "band", "", ""}));
  EXPECT_EQ(cause(error("basis: too skew")), (ErrorCause{"BAD_SPEC", "lattice.basis", "", ""}));
  EXPECT_EQ(cause(error("mesh: it is not closed")), (ErrorCause{"BAD_MESH", "mesh", "", ""}));
  EXPECT_EQ(CauseOf(WithCauseOfCore(too_fine))->field, "lattice.basis");
}

TEST(ErrorTable, KeepsTheFirstCause) {
  const absl::Status status = WithCause(BadMesh("no triangles"), {"OTHER", "other", "", ""});
  EXPECT_EQ(ErrorInfoOf(ToGrpcStatus(status)).reason(), "BAD_MESH");
  EXPECT_TRUE(WithCause(absl::OkStatus(), {"OTHER", "", "", ""}).ok());
  EXPECT_EQ(RetryDelayOf(status), std::nullopt);
}

}  // namespace
}  // namespace latvox
