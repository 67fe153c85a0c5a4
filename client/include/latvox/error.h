// Details of an error for programs, besides its absl::Status code and its line for people.
#ifndef LATVOX_LATVOX_ERROR_H_
#define LATVOX_LATVOX_ERROR_H_

#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "latvox/export.h"

namespace latvox::client {

// Details of an error. Empty texts: not known.
//
// The protocol's codes:
//   INVALID_ARGUMENT     the request or the mesh is wrong
//   RESOURCE_EXHAUSTED   a limit is exceeded; or the server is full, and RetryPolicy has run out (with retry_after)
//   NOT_FOUND            the server has no mesh with this MeshId
//   UNAVAILABLE          no server could be reached, or kept, within RetryPolicy
//   DEADLINE_EXCEEDED    CallOptions.deadline has passed
//   CANCELLED            the caller cancelled the call
//   UNAUTHENTICATED      the server requires a token
//   INTERNAL             a defect of the server
//   DATA_LOSS            the server broke the protocol
struct ErrorDetails {
  std::string reason;                         // UPPER_SNAKE_CASE, for example "BAD_SPEC"
  std::string field;                          // the wrong field
  std::string value;                          // its value
  std::string limit;                          // the allowed limit
  std::optional<absl::Duration> retry_after;  // the same call may succeed after this time
  std::string other = "";                     // the field that excludes `field`, if the two together are wrong
};

// Returns the details of a status of this SDK, from the server's google.rpc.ErrorInfo and RetryInfo, or from the client
// itself. All are empty if there are none. A status keeps them as texts, one payload each, so it prints as one readable
// line: "INVALID_ARGUMENT: resolution 70000 exceeds 65536 [latvox.field='resolution'] ...".
LATVOX_EXPORT ErrorDetails GetErrorDetails(const absl::Status& status);

// Sets the details of a status, and replaces old ones. An OK status stays as it is.
LATVOX_EXPORT void SetErrorDetails(const ErrorDetails& details, absl::Status& status);

// Reads ErrorInfo and RetryInfo from a serialized google.rpc.Status, as in grpc-status-details-bin, and sets them on
// the status. Ignores bytes that are not such a message, because they come from outside, and the status itself is still
// valid.
LATVOX_EXPORT void AttachWireDetails(const std::string& serialized_rpc_status, absl::Status& status);

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_ERROR_H_
