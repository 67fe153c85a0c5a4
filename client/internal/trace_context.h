// W3C Trace Context, https://www.w3.org/TR/trace-context: what may be sent of it. Internal to the SDK and its programs.
#ifndef LATVOX_CLIENT_INTERNAL_TRACE_CONTEXT_H_
#define LATVOX_CLIENT_INTERNAL_TRACE_CONTEXT_H_

#include "absl/strings/string_view.h"

namespace latvox::client {

// Whether the value of "traceparent" is well-formed: of version 00, or of a later one as far as that is to be like 00.
bool IsTraceparent(absl::string_view value);

// Whether the value of "tracestate" may stand in metadata: 1 to 512 visible ASCII characters and spaces. What its
// entries mean is between those who write and read them.
bool IsTracestate(absl::string_view value);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_TRACE_CONTEXT_H_
