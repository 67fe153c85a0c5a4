// Lengths of SVG, and the boxes that they refer to.
#ifndef LATVOX_CLIENT_TOOL_CURVE_SVG_VIEWPORT_H_
#define LATVOX_CLIENT_TOOL_CURVE_SVG_VIEWPORT_H_

#include <optional>
#include <pugixml.hpp>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "client/tool/curve/svg_transform.h"
#include "latvox/plane_types.h"

namespace latvox::client {

// The box that percentages refer to, in user units. Absent: the drawing does not tell.
struct Viewport {
  std::optional<double> width, height;
};

// The direction that a percentage of the viewport refers to.
enum class Along { kX, kY, kBoth };

// Reads an attribute in user units, 96 to an inch; leaves `value` if the element lacks it. Errors: INVALID_ARGUMENT
// naming the attribute: no finite number, a unit of fonts or an unknown one, a percentage of an absent viewport.
absl::Status ReadLength(const pugi::xml_node& node, const char* name, Along along, const Viewport& viewport,
                        double& value);

// The part of a drawing that a viewBox shows, in user units.
struct ViewBox {
  Vec2d low, size;
};

// Returns nothing without four numbers, or without a size.
std::optional<ViewBox> ParseViewBox(absl::string_view text);

// Returns the transform of a view box onto a viewport of this size: SVG 2, "The preserveAspectRatio attribute".
Affine FitViewBox(const ViewBox& view, const Vec2d& viewport, absl::string_view aspect);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CURVE_SVG_VIEWPORT_H_
