// The path data of SVG: outlines of lines and Bezier curves.
#ifndef LATVOX_CLIENT_TOOL_CURVE_SVG_PATH_H_
#define LATVOX_CLIENT_TOOL_CURVE_SVG_PATH_H_

#include <array>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "latvox/plane_types.h"

namespace latvox::client {

// A line or a Bezier curve from where the piece before it ends.
struct OutlinePiece {
  size_t degree;                 // 1, 2 or 3
  std::array<Vec2d, 3> control;  // the first `degree` of them; the last is the end

  const Vec2d& end() const { return control[degree - 1]; }
};

struct Outline {
  Vec2d start{};
  std::vector<OutlinePiece> pieces;
  bool closed = false;
};

// Appends the outlines of path data with the commands M L H V Z C Q, absolute or relative (small letters). Outlines
// without a piece are left out. Errors: INVALID_ARGUMENT naming the text, or the command that is not one of these.
absl::Status ParsePathData(absl::string_view data, std::vector<Outline>& outlines);

// The outline as a polyline whose points lie on it and which nowhere leaves it by more than `tolerance` > 0; lines are
// taken over as they are.
Polyline Flatten(const Outline& outline, double tolerance);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CURVE_SVG_PATH_H_
