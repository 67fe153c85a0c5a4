// W3C Trace Context, https://www.w3.org/TR/trace-context: how a call belongs to a trace that began elsewhere.
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
  std::string flags;      // 2; 01: the caller records the trace
};

// From the value of "traceparent", with a span id of its own. Nothing if it is malformed: then the caller is as one
// without a trace. Of a later version than 00, what version 00 has counts.
std::optional<TraceContext> ReadTraceparent(absl::string_view value);

// The value of "traceparent" for what comes after this call.
std::string Traceparent(const TraceContext& trace);

}  // namespace latvox

#endif  // LATVOX_SERVER_ACCESS_TRACE_CONTEXT_H_
