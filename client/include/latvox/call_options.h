// Options of every call.
#ifndef LATVOX_LATVOX_CALL_OPTIONS_H_
#define LATVOX_LATVOX_CALL_OPTIONS_H_

#include <optional>
#include <string>

#include "absl/time/time.h"
#include "latvox/cancellation.h"
#include "latvox/retry_policy.h"

namespace latvox::client {

// All are optional.
struct CallOptions {
  std::optional<absl::Time> deadline = std::nullopt;  // DEADLINE_EXCEEDED after it, over all tries; default: none
  Cancellation cancellation = {};                     // CANCELLED soon after its Cancel()
  RetryPolicy retry = {};                             // number and timing of further tries
  std::string traceparent = {};                       // W3C trace context of the call; a malformed one is not sent
  std::string tracestate = {};  // its vendor part; sent only with a valid traceparent, up to 512 characters
};

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_CALL_OPTIONS_H_
