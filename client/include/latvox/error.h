// What programs need to know about an error, besides its absl::Status code and its line for people.
#ifndef LATVOX_LATVOX_ERROR_H_
#define LATVOX_LATVOX_ERROR_H_

#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "latvox/export.h"

namespace latvox::client {

// What stands behind an error. Empty strings: not known.
//
// Codes, as the protocol has them: INVALID_ARGUMENT: the request or the mesh is wrong. RESOURCE_EXHAUSTED: a limit, or
// the server is full (then with retry_after, and only once RetryPolicy has run out). NOT_FOUND: the server has no mesh
// of this MeshId. UNAVAILABLE: no server could be reached, or kept, within RetryPolicy. DEADLINE_EXCEEDED, CANCELLED.
// UNAUTHENTICATED: the server wants a token. INTERNAL: a defect of the server. DATA_LOSS: the server broke the
// protocol.
struct ErrorDetails {
  std::string reason;                         // UPPER_SNAKE_CASE, for example "BAD_SPEC"
  std::string field;                          // the offending one
  std::string value;                          // what it was
  std::string limit;                          // what is allowed
  std::optional<absl::Duration> retry_after;  // trying the same again can help, after this long
  std::string other = "";                     // the field that excludes `field`, if both together are wrong
};

// The details that came with a status of this SDK: from the server's google.rpc.ErrorInfo and RetryInfo, or from the
// client itself. All empty if there are none.
LATVOX_EXPORT ErrorDetails GetErrorDetails(const absl::Status& status);

// Puts the details on the status, replacing those that are there. An OK status stays as it is.
LATVOX_EXPORT void SetErrorDetails(const ErrorDetails& details, absl::Status& status);

// Takes ErrorInfo and RetryInfo out of a serialized google.rpc.Status, as grpc-status-details-bin carries it, and puts
// them on the status. Bytes that are not one are ignored: they come from outside, and the status itself still holds.
LATVOX_EXPORT void AttachWireDetails(const std::string& serialized_rpc_status, absl::Status& status);

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_ERROR_H_
