// The curves of an SVG drawing.
#ifndef LATVOX_CLIENT_TOOL_CURVE_SVG_CURVES_H_
#define LATVOX_CLIENT_TOOL_CURVE_SVG_CURVES_H_

#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "latvox/plane_types.h"

namespace latvox::client {

// Tolerance of flattening, as a share of the longer side of the box of all control points. It is about one pixel at the
// finest resolution.
inline constexpr double kFlatness = 1.0 / 65536;

// Reads the elements polyline, polygon, line, rect (with sharp corners) and path (see client/tool/curve/svg_path.h),
// also within g, with their transforms translate, scale and matrix.
// World coordinates are the numbers of the drawing, y downwards. width, height, viewBox and styles are ignored.
// Elements that draw nothing (title, desc, metadata, defs, style) and those of other namespaces are skipped.
// Errors: INVALID_ARGUMENT naming line and element: not XML, any other element, transform or path command, a length
// with a unit, a number that is not finite.
absl::StatusOr<std::vector<Polyline>> ParseSvg(absl::string_view text);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CURVE_SVG_CURVES_H_
