// What every call can be told.
#ifndef LATVOX_LATVOX_CALL_OPTIONS_H_
#define LATVOX_LATVOX_CALL_OPTIONS_H_

#include <optional>
#include <string>

#include "absl/time/time.h"
#include "latvox/cancellation.h"
#include "latvox/retry_policy.h"

namespace latvox::client {

// All may be left out.
struct CallOptions {
  std::optional<absl::Time> deadline;  // DEADLINE_EXCEEDED after it, over all tries; default: none
  Cancellation cancellation = {};      // CANCELLED soon after its Cancel()
  RetryPolicy retry = {};              // how often and how soon to try again
  std::string traceparent = {};        // W3C trace context that the call belongs to; a malformed one is not sent
  std::string tracestate = {};         // what goes with it; sent with a good traceparent only, up to 512 characters
};

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_CALL_OPTIONS_H_
