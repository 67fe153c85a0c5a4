// Checks values of W3C Trace Context before they are sent: https://www.w3.org/TR/trace-context. Internal to the SDK and
// its programs.
#ifndef LATVOX_CLIENT_INTERNAL_TRACE_CONTEXT_H_
#define LATVOX_CLIENT_INTERNAL_TRACE_CONTEXT_H_

#include "absl/strings/string_view.h"

namespace latvox::client {

// Returns whether a value of "traceparent" is well-formed: of version 00, or of a later one in its common part.
bool IsTraceparent(absl::string_view value);

// Returns whether a value of "tracestate" is valid in metadata: 1 to 512 visible ASCII characters and spaces. Only its
// writers and readers know the meaning of its entries.
bool IsTracestate(absl::string_view value);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_TRACE_CONTEXT_H_
