#include "client/tool/curve/svg_arc.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace latvox::client {
namespace {

// An ellipse by its center and the vectors to two ends of conjugate diameters.
struct Ellipse {
  Vec2d center, u, v;

  Vec2d At(double cos, double sin) const {
    return {center[0] + cos * u[0] + sin * v[0], center[1] + cos * u[1] + sin * v[1]};
  }
};

// Appends the arc from the angle `from` on. A cubic that has the arc's ends and tangents, and its middle, has control
// points at 4/3 tan(step / 4) along the tangents.
void AppendTurn(const Ellipse& ellipse, double from, double turn, std::vector<OutlinePiece>& pieces) {
  constexpr double kMostStep = std::numbers::pi / 8;
  const double count = std::max(1.0, std::ceil(std::abs(turn) / kMostStep * (1 - 1e-12)));
  const double step = turn / count, handle = 4.0 / 3 * std::tan(step / 4);
  for (double n = 0; n < count; ++n) {
    const double a = from + n * step, b = from + (n + 1) * step;
    const double cos_a = std::cos(a), sin_a = std::sin(a), cos_b = std::cos(b), sin_b = std::sin(b);
    pieces.push_back({3,
                      {ellipse.At(cos_a - handle * sin_a, sin_a + handle * cos_a),
                       ellipse.At(cos_b + handle * sin_b, sin_b - handle * cos_b), ellipse.At(cos_b, sin_b)}});
  }
}

}  // namespace

void AppendArc(const Vec2d& start, const Arc& arc, std::vector<OutlinePiece>& pieces) {
  if (start == arc.end) return;
  double rx = std::abs(arc.radii[0]), ry = std::abs(arc.radii[1]);
  if (rx == 0 || ry == 0) {
    pieces.push_back({1, {arc.end}});
    return;
  }
  // In the frame of the ellipse, scaled to a unit circle, the ends are at +half and -half from the middle of the chord.
  const double angle = arc.rotation * std::numbers::pi / 180, cos = std::cos(angle), sin = std::sin(angle);
  const double dx = (start[0] - arc.end[0]) / 2, dy = (start[1] - arc.end[1]) / 2;
  Vec2d half = {(cos * dx + sin * dy) / rx, (cos * dy - sin * dx) / ry};
  const double length = std::hypot(half[0], half[1]);
  if (length > 1) {
    rx *= length;
    ry *= length;
    half = {half[0] / length, half[1] / length};
  }
  // The center is beside the middle, at a right angle to the chord.
  const double square = half[0] * half[0] + half[1] * half[1];
  const double aside = std::sqrt(std::max(0.0, 1 / square - 1)) * (arc.large == arc.sweep ? -1 : 1);
  const Vec2d middle = {aside * half[1], -aside * half[0]};
  const double from = std::atan2(half[1] - middle[1], half[0] - middle[0]);
  double turn = std::atan2(-half[1] - middle[1], -half[0] - middle[0]) - from;
  if (arc.sweep && turn < 0) turn += 2 * std::numbers::pi;
  if (!arc.sweep && turn > 0) turn -= 2 * std::numbers::pi;
  Ellipse ellipse{{}, {rx * cos, rx * sin}, {-ry * sin, ry * cos}};
  ellipse.center = {start[0] / 2 + arc.end[0] / 2, start[1] / 2 + arc.end[1] / 2};
  ellipse.center = ellipse.At(middle[0], middle[1]);
  AppendTurn(ellipse, from, turn, pieces);
  pieces.back().control[2] = arc.end;  // without rounding
}

Outline EllipseOutline(const Vec2d& center, const Vec2d& radii) {
  Outline outline{{center[0] + radii[0], center[1]}, {}, true};
  AppendTurn({center, {radii[0], 0}, {0, radii[1]}}, 0, 2 * std::numbers::pi, outline.pieces);
  outline.pieces.back().control[2] = outline.start;
  return outline;
}

}  // namespace latvox::client
