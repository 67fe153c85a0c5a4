// The path data of SVG: outlines of lines and Bezier curves.
#ifndef LATVOX_CLIENT_TOOL_CURVE_SVG_PATH_H_
#define LATVOX_CLIENT_TOOL_CURVE_SVG_PATH_H_

#include <array>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "latvox/plane_types.h"

namespace latvox::client {

// A line or a Bezier curve that begins at the end of the previous piece.
struct OutlinePiece {
  size_t degree;                 // 1, 2 or 3
  std::array<Vec2d, 3> control;  // the first `degree` are used; the last of them is the end

  const Vec2d& end() const { return control[degree - 1]; }
};

struct Outline {
  Vec2d start{};
  std::vector<OutlinePiece> pieces;
  bool closed = false;
};

// Appends the outlines of path data with the commands M L H V Z C S Q T A, absolute or relative (lower case). Omits
// outlines without a piece. Errors: INVALID_ARGUMENT naming the text, or a command that is not one of these.
absl::Status ParsePathData(absl::string_view data, std::vector<Outline>& outlines);

// Returns the outline as a polyline whose points lie on it and that deviates from it by at most `tolerance` > 0. Lines
// are kept as they are.
Polyline Flatten(const Outline& outline, double tolerance);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CURVE_SVG_PATH_H_
