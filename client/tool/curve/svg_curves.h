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

// Reads the outlines of all shapes: polyline, polygon, line, rect, circle, ellipse and path (see
// client/tool/curve/svg_path.h), within g, a, switch, svg, and by use, with their transforms and lengths. World
// coordinates are the numbers of the drawing, y downwards: width, height and viewBox of the root only tell what
// percentages mean. Attributes, the attribute `style` and style sheets give the values: see client/tool/curve/css.h.
// Colors, strokes and clips are ignored. Elements are skipped that `display` or `visibility` hides, that draw nothing
// (such as defs), and those of other namespaces.
// Errors: INVALID_ARGUMENT naming line and element: not XML; text, an image or any other element; a transform, path
// command or unit that SVG does not have; a number that is not finite; more than a million elements or ten million
// pieces. Styles add what css.h refuses, units of fonts and windows, and a transform-box other than view-box.
absl::StatusOr<std::vector<Polyline>> ParseSvg(absl::string_view text);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CURVE_SVG_CURVES_H_
