// The shapes of SVG, as outlines.
#ifndef LATVOX_CLIENT_TOOL_CURVE_SVG_SHAPES_H_
#define LATVOX_CLIENT_TOOL_CURVE_SVG_SHAPES_H_

#include <pugixml.hpp>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "client/tool/curve/svg_length.h"
#include "client/tool/curve/svg_path.h"

namespace latvox::client {

// Appends the outlines of a polyline, polygon, line, rect, circle, ellipse or path, before its transform. A shape
// without a size has none. Errors: INVALID_ARGUMENT: another element, a negative size, a wrong number or path.
//   name   of the element, without a prefix
absl::Status AppendShape(const pugi::xml_node& node, absl::string_view name, const Viewport& viewport,
                         std::vector<Outline>& outlines);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CURVE_SVG_SHAPES_H_
