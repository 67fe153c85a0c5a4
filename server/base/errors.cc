#include "server/base/errors.h"

#include <google/protobuf/any.pb.h>

#include <utility>

#include "absl/strings/cord.h"
#include "absl/strings/str_cat.h"
#include "core/base/status_payload.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"

namespace latvox {
namespace {

constexpr char kErrorInfoUrl[] = "type.googleapis.com/google.rpc.ErrorInfo";
constexpr char kRetryInfoUrl[] = "type.googleapis.com/google.rpc.RetryInfo";

// The limits of GetLimits, by the fields that they bound.
absl::string_view LimitNameOf(absl::string_view field) {
  static constexpr std::pair<absl::string_view, absl::string_view> kNames[] = {
      {"mesh_bytes", "max_mesh_bytes"},     {"mesh.triangles", "max_triangles"},
      {"mesh.vertices", "max_vertices"},    {"visited_points", "max_visited_points"},
      {"job_seconds", "max_job_seconds"},   {"message_bytes", "max_message_bytes"},
      {"memory", "memory_budget_bytes"},    {"points", "max_points"},
      {"crossings", "max_crossings"},       {"pixels", "max_pixels"},
      {"answer_bytes", "max_message_bytes"}};
  for (const auto& [name, limit] : kNames) {
    if (name == field) return limit;
  }
  return {};
}

google::rpc::ErrorInfo ToProto(const ErrorCause& cause) {
  google::rpc::ErrorInfo info;
  info.set_reason(cause.reason);
  info.set_domain(std::string{kErrorDomain});
  auto& metadata = *info.mutable_metadata();
  if (!cause.field.empty()) metadata["field"] = cause.field;
  if (!cause.value.empty()) metadata["value"] = cause.value;
  if (!cause.limit.empty()) metadata["limit"] = cause.limit;
  const bool has_known_limit = cause.limit_name.empty() && cause.reason == "LIMIT_EXCEEDED";
  const absl::string_view limit_name = has_known_limit ? LimitNameOf(cause.field) : cause.limit_name;
  if (!cause.other.empty()) metadata["other"] = cause.other;
  if (!limit_name.empty()) metadata["limit_name"] = std::string{limit_name};
  return info;
}

grpc::StatusCode ToGrpcCode(absl::StatusCode code) {
  switch (code) {
    case absl::StatusCode::kOk:
      return grpc::StatusCode::OK;
    case absl::StatusCode::kInvalidArgument:
      return grpc::StatusCode::INVALID_ARGUMENT;
    case absl::StatusCode::kResourceExhausted:
      return grpc::StatusCode::RESOURCE_EXHAUSTED;
    case absl::StatusCode::kCancelled:
      return grpc::StatusCode::CANCELLED;
    case absl::StatusCode::kDeadlineExceeded:
      return grpc::StatusCode::DEADLINE_EXCEEDED;
    case absl::StatusCode::kNotFound:
      return grpc::StatusCode::NOT_FOUND;
    case absl::StatusCode::kUnavailable:
      return grpc::StatusCode::UNAVAILABLE;
    case absl::StatusCode::kUnauthenticated:
      return grpc::StatusCode::UNAUTHENTICATED;
    default:
      return grpc::StatusCode::INTERNAL;
  }
}

// The content of ErrorInfo for an error without a cause of its own.
ErrorCause CauseByCode(const absl::Status& status) { return {absl::StatusCodeToString(status.code()), "", "", ""}; }

void AddDetail(absl::string_view url, const absl::Cord& bytes, google::rpc::Status& out) {
  google::protobuf::Any& any = *out.add_details();
  any.set_type_url(std::string{url});
  any.set_value(std::string{bytes});
}

}  // namespace

absl::Status MakeError(absl::StatusCode code, absl::string_view message, const ErrorCause& cause) {
  return WithCause(absl::Status(code, message), cause);
}

absl::Status BadSpec(absl::string_view message, absl::string_view field, absl::string_view value,
                     absl::string_view limit) {
  return MakeError(absl::StatusCode::kInvalidArgument, message,
                   {"BAD_SPEC", std::string{field}, std::string{value}, std::string{limit}});
}

absl::Status BadMesh(absl::string_view message) {
  return MakeError(absl::StatusCode::kInvalidArgument, absl::StrCat("mesh: ", message), {"BAD_MESH", "mesh", "", ""});
}

absl::Status BadStream(absl::string_view message) {
  return MakeError(absl::StatusCode::kInvalidArgument, message, {"BAD_STREAM", "part", "", ""});
}

absl::Status LimitExceeded(absl::string_view field, uint64_t value, uint64_t limit, absl::string_view limit_name) {
  return MakeError(
      absl::StatusCode::kResourceExhausted, absl::StrCat(field, " ", value, " exceeds ", limit),
      {"LIMIT_EXCEEDED", std::string{field}, absl::StrCat(value), absl::StrCat(limit), std::string{limit_name}});
}

std::optional<ErrorCause> CauseOf(const absl::Status& status) {
  const auto payload = status.GetPayload(kErrorInfoUrl);
  google::rpc::ErrorInfo info;
  if (!payload || !info.ParseFromString(std::string{*payload})) return std::nullopt;
  const auto value = [&](const char* key) {
    const auto found = info.metadata().find(key);
    return found == info.metadata().end() ? std::string() : found->second;
  };
  return ErrorCause{info.reason(), value("field"), value("value"), value("limit"), value("limit_name"), value("other")};
}

absl::Status WithCause(absl::Status status, const ErrorCause& cause) {
  if (status.ok() || status.GetPayload(kErrorInfoUrl)) return status;
  status.SetPayload(kErrorInfoUrl, absl::Cord(ToProto(cause).SerializeAsString()));
  return status;
}

std::string ReasonOf(const absl::Status& status) {
  if (status.ok()) return "";
  const auto payload = WithCause(status, CauseByCode(status)).GetPayload(kErrorInfoUrl);
  google::rpc::ErrorInfo info;
  return payload && info.ParseFromString(std::string{*payload}) ? info.reason() : "";
}

absl::Status WithCauseOfCore(absl::Status status, const RequestFields& fields) {
  const bool exceeds = status.code() == absl::StatusCode::kResourceExhausted;
  if (!exceeds && status.code() != absl::StatusCode::kInvalidArgument) return status;
  const auto payload = [&](const char* url) { return std::string{status.GetPayload(url).value_or(absl::Cord())}; };
  std::string field = payload(kRefusedField);
  if (field.empty()) field = std::string{status.message().substr(0, status.message().find(':'))};
  const char* const reason = exceeds ? "LIMIT_EXCEEDED" : field == "mesh" ? "BAD_MESH" : "BAD_SPEC";
  ErrorCause cause{reason, field, payload(kRefusedValue), payload(kRefusedLimit)};
  cause.other = payload(kRefusedOther);
  if (field == "basis") cause.field = "lattice.basis";
  if (field == "band" && !cause.value.empty()) cause.field = fields.band;
  if (field == "voxel_size" || field == "pixel_size") {
    cause.field = fields.sampling;
    if (exceeds) cause.limit_name = "max_extent";
  }
  if (field == "fraction_n" && exceeds) cause.limit_name = "max_extent";
  return WithCause(std::move(status), cause);
}

absl::Status WithRetry(absl::Status status, absl::Duration delay) {
  google::rpc::RetryInfo info;
  absl::Duration rest;
  info.mutable_retry_delay()->set_seconds(absl::IDivDuration(delay, absl::Seconds(1), &rest));
  info.mutable_retry_delay()->set_nanos(static_cast<int32_t>(absl::ToInt64Nanoseconds(rest)));
  status.SetPayload(kRetryInfoUrl, absl::Cord(info.SerializeAsString()));
  return status;
}

std::optional<absl::Duration> RetryDelayOf(const absl::Status& status) {
  const auto payload = status.GetPayload(kRetryInfoUrl);
  google::rpc::RetryInfo info;
  if (!payload || !info.ParseFromString(std::string{*payload})) return std::nullopt;
  return absl::Seconds(info.retry_delay().seconds()) + absl::Nanoseconds(info.retry_delay().nanos());
}

absl::StatusCode CodeOnWire(const absl::Status& status) {
  return static_cast<absl::StatusCode>(ToGrpcCode(status.code()));
}

grpc::Status ToGrpcStatus(const absl::Status& status) {
  if (status.ok()) return grpc::Status::OK;
  const grpc::StatusCode code = ToGrpcCode(status.code());
  google::rpc::Status details;
  details.set_code(static_cast<int32_t>(code));
  details.set_message(std::string{status.message()});
  const absl::Status complete = WithCause(status, CauseByCode(status));
  for (const char* url : {kErrorInfoUrl, kRetryInfoUrl}) {
    if (const auto payload = complete.GetPayload(url)) AddDetail(url, *payload, details);
  }
  return grpc::Status(code, details.message(), details.SerializeAsString());
}

}  // namespace latvox
