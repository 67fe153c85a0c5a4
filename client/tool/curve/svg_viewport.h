// View boxes of SVG.
#ifndef LATVOX_CLIENT_TOOL_CURVE_SVG_VIEWPORT_H_
#define LATVOX_CLIENT_TOOL_CURVE_SVG_VIEWPORT_H_

#include <optional>

#include "absl/strings/string_view.h"
#include "client/tool/curve/svg_transform.h"
#include "latvox/plane_types.h"

namespace latvox::client {

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
