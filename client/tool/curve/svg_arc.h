// The arcs of SVG, as Bezier curves.
#ifndef LATVOX_CLIENT_TOOL_CURVE_SVG_ARC_H_
#define LATVOX_CLIENT_TOOL_CURVE_SVG_ARC_H_

#include <vector>

#include "client/tool/curve/svg_path.h"
#include "latvox/plane_types.h"

namespace latvox::client {

// An arc of an ellipse to a point, as the path command A describes it.
struct Arc {
  Vec2d radii{};        // their signs do not matter
  double rotation = 0;  // of the ellipse's x axis, in degrees
  bool large = false;   // more than half of the ellipse
  bool sweep = false;   // toward increasing angles
  Vec2d end{};
};

// Appends cubic pieces, whose ends are on the arc. Each of them is at most a sixteenth of the ellipse, and deviates
// from it by less than 1e-7 of its radius. By the SVG standard, an arc with a radius of 0 is a line, one that ends
// where it starts is nothing, and radii that are too small grow (SVG 2, "Elliptical arc implementation notes").
void AppendArc(const Vec2d& start, const Arc& arc, std::vector<OutlinePiece>& pieces);

// Returns the whole ellipse, from its greatest x on.
Outline EllipseOutline(const Vec2d& center, const Vec2d& radii);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CURVE_SVG_ARC_H_
