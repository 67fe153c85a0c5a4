// Polylines in plain text.
#ifndef LATVOX_CLIENT_TOOL_CURVE_TEXT_CURVES_H_
#define LATVOX_CLIENT_TOOL_CURVE_TEXT_CURVES_H_

#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "latvox/plane_types.h"

namespace latvox::client {

// Reads one polyline per line: points "x,y" separated by white space, as the nearest doubles to the decimal text. A "z"
// at the end closes the polyline. "#" begins a comment; empty lines are skipped.
// Errors: INVALID_ARGUMENT naming line and text.
absl::StatusOr<std::vector<Polyline>> ParseText(absl::string_view text);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CURVE_TEXT_CURVES_H_
