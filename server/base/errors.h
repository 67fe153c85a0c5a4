// Errors on their way to the client: absl::Status inside the server, grpc::Status with google.rpc details on the wire.
#ifndef LATVOX_SERVER_BASE_ERRORS_H_
#define LATVOX_SERVER_BASE_ERRORS_H_

#include <grpcpp/support/status.h>

#include <optional>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"

namespace latvox {

// The ErrorInfo.domain of every error.
inline constexpr absl::string_view kErrorDomain = "latvox";

// The codes that the contract names.
inline constexpr absl::StatusCode kCodes[] = {
    absl::StatusCode::kOk,          absl::StatusCode::kInvalidArgument,  absl::StatusCode::kResourceExhausted,
    absl::StatusCode::kNotFound,    absl::StatusCode::kUnauthenticated,  absl::StatusCode::kCancelled,
    absl::StatusCode::kUnavailable, absl::StatusCode::kDeadlineExceeded, absl::StatusCode::kInternal};

inline constexpr char kMeshNotFound[] = "MESH_NOT_FOUND";

// The reasons in the contract's table. An error without a reason has its code as the reason.
inline constexpr absl::string_view kReasons[] = {
    "BAD_SPEC",     "BAD_MESH",        "BAD_STREAM",    "LIMIT_EXCEEDED",          "MEMORY_IN_USE",   "OUT_OF_MEMORY",
    "DECODER_TIME", "DECODER_KILLED",  "TOO_MANY_JOBS", "TOO_MANY_JOBS_OF_CLIENT", "SERVER_STOPPING", "CLIENT_STALLED",
    kMeshNotFound,  "UNAUTHENTICATED", "WRONG_OFFSET",  "TOO_MANY_UPLOADS"};

// The trailer that tells gRPC's built-in retries how many milliseconds to wait.
inline constexpr char kPushbackTrailer[] = "grpc-retry-pushback-ms";

// The facts about an error that programs need besides its code. Empty members are not sent.
struct ErrorCause {
  std::string reason;  // UPPER_SNAKE_CASE, becomes ErrorInfo.reason
  std::string field;
  std::string value;
  std::string limit;
  std::string limit_name = "";  // the field of GetLimitsResponse with the limit, for LIMIT_EXCEEDED
  std::string other = "";       // the field that excludes this one

  bool operator==(const ErrorCause&) const = default;
};

absl::Status MakeError(absl::StatusCode code, absl::string_view message, const ErrorCause& cause);

// INVALID_ARGUMENT with the reason BAD_<what>: BAD_SPEC, BAD_MESH, BAD_STREAM.
absl::Status BadSpec(absl::string_view message, absl::string_view field, absl::string_view value,
                     absl::string_view limit = {});
absl::Status BadMesh(absl::string_view message);
absl::Status BadStream(absl::string_view message);

// Returns RESOURCE_EXHAUSTED with the reason LIMIT_EXCEEDED and the message "field value exceeds limit". A retry is
// pointless.
absl::Status LimitExceeded(absl::string_view field, uint64_t value, uint64_t limit, absl::string_view limit_name = {});

// Returns the cause that was added to the status, if any.
std::optional<ErrorCause> CauseOf(const absl::Status& status);

// Returns ErrorInfo.reason as the client gets it, or an empty text if the status is OK.
std::string ReasonOf(const absl::Status& status);

// Returns the same status with `cause`, unless it is OK or has a cause already.
absl::Status WithCause(absl::Status status, const ErrorCause& cause);

// The names in a request of some of core's fields.
struct RequestFields {
  std::string_view sampling = "lattice.basis";  // voxel_size, pixel_size or resolution
  std::string_view band = "band";
};

// Does the same for an error of core, which does not know the wire. Payloads of the status hold field, value and limit
// (core/base/status_payload.h). Without a field there, the message begins with the field and a colon.
absl::Status WithCauseOfCore(absl::Status status, const RequestFields& fields = {});

// Returns the same status with the advice to try again after `delay`.
absl::Status WithRetry(absl::Status status, absl::Duration delay);
std::optional<absl::Duration> RetryDelayOf(const absl::Status& status);

// Returns the code that the client gets.
absl::StatusCode CodeOnWire(const absl::Status& status);

// Converts a status by the one table. Codes that the contract does not name become INTERNAL. grpc-status-details-bin
// holds a google.rpc.Status with one ErrorInfo and, after WithRetry, one RetryInfo.
grpc::Status ToGrpcStatus(const absl::Status& status);

}  // namespace latvox

#endif  // LATVOX_SERVER_BASE_ERRORS_H_
