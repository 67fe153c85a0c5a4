// The transforms of SVG.
#ifndef LATVOX_CLIENT_TOOL_CURVE_SVG_TRANSFORM_H_
#define LATVOX_CLIENT_TOOL_CURVE_SVG_TRANSFORM_H_

#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/tool/curve/svg_length.h"
#include "latvox/plane_types.h"

namespace latvox::client {

// x' = a*x + c*y + e,  y' = b*x + d*y + f
struct Affine {
  double a = 1, b = 0, c = 0, d = 1, e = 0, f = 0;

  Vec2d operator()(const Vec2d& p) const { return {a * p[0] + c * p[1] + e, b * p[0] + d * p[1] + f}; }
};

Affine Translation(double x, double y);

// Returns the transform that applies `inner` first, then `outer`.
Affine Compose(const Affine& outer, const Affine& inner);

// Reads a list of the plane transforms of SVG and CSS: translate, scale, rotate, skew and matrix, also along one axis.
// Lengths and angles may have units; without one, they are user units and degrees. Multiples of 90 degrees are exact.
// Errors: INVALID_ARGUMENT naming the text.
//   viewport   what percentages refer to
absl::StatusOr<Affine> ParseTransforms(absl::string_view text, const Viewport& viewport);

// CSS is stricter than attributes: it demands units, and commas between arguments but none between transforms. Errors:
// INVALID_ARGUMENT with the reason. The text may still be no transform or origin.
absl::Status CheckCssTransforms(absl::string_view text);
absl::Status CheckCssOrigin(absl::string_view text);

// Reads a transform-origin, the fixed point of the transforms. Errors: INVALID_ARGUMENT naming the text.
absl::StatusOr<Vec2d> ParseOrigin(absl::string_view text, const Viewport& viewport);

// Reads all numbers of a list separated by white space or commas. Returns false at anything else.
bool ParseNumbers(absl::string_view text, std::vector<double>& numbers);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CURVE_SVG_TRANSFORM_H_
