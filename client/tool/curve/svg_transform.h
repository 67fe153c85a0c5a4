// The transforms of SVG.
#ifndef LATVOX_CLIENT_TOOL_CURVE_SVG_TRANSFORM_H_
#define LATVOX_CLIENT_TOOL_CURVE_SVG_TRANSFORM_H_

#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
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

// Reads a list of translate, scale, rotate, skewX, skewY and matrix; angles are degrees. Multiples of 90 degrees are
// exact. Errors: INVALID_ARGUMENT naming the text.
absl::StatusOr<Affine> ParseTransforms(absl::string_view text);

// Reads all numbers of a list separated by white space or commas. Returns false at anything else.
bool ParseNumbers(absl::string_view text, std::vector<double>& numbers);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CURVE_SVG_TRANSFORM_H_
