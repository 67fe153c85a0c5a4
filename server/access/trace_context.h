// W3C Trace Context, https://www.w3.org/TR/trace-context: connects a call to a trace that began elsewhere.
#ifndef LATVOX_SERVER_ACCESS_TRACE_CONTEXT_H_
#define LATVOX_SERVER_ACCESS_TRACE_CONTEXT_H_

#include <optional>
#include <string>

#include "absl/strings/string_view.h"

namespace latvox {

struct TraceContext {
  std::string trace_id;   // 32 lower-case hexadecimal digits, not all 0
  std::string parent_id;  // 16; the caller's span
  std::string span_id;    // 16; this call's own, random
  std::string flags;      // 2 digits; 01: the caller records the trace
};

// Reads the value of "traceparent", and adds a span id of its own. Returns nothing if the value is malformed, as if the
// caller had no trace. Reads the fields of version 00 also from later versions.
std::optional<TraceContext> ReadTraceparent(absl::string_view value);

// The value of "traceparent" for calls that follow from this one.
std::string Traceparent(const TraceContext& trace);

}  // namespace latvox

#endif  // LATVOX_SERVER_ACCESS_TRACE_CONTEXT_H_
