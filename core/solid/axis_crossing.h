// The crossing rule (core/digitize/crossing.h) along the axes of the lattice coordinates, with signs. It does not round
// to nearer ends, but finds the two points of a line between which a triangle crosses it, and the sense of the
// crossing.
//
// It is not ForEachCrossing along three unit vectors, for three reasons. Its lines may belong to a coarser lattice,
// such as that of the tiles' corners. It gives the sense of each crossing. And for rows that are unit vectors, most
// terms of a frame vanish. The two rules share only exact division.
//
// The shift by (e, e^2, e^3) is the same as there. No lattice point lies on the shifted surface, so every point is
// inside or outside. All axes agree on it, whatever the lattice, because only lattice coordinates matter.
#ifndef LATVOX_CORE_SOLID_AXIS_CROSSING_H_
#define LATVOX_CORE_SOLID_AXIS_CROSSING_H_

#include <algorithm>
#include <cstdint>
#include <utility>

#include "core/base/vec.h"
#include "core/digitize/crossing.h"
#include "core/snap/snap.h"

namespace latvox {

// Lines along one axis: their coordinates on the two axes that follow it cyclically, both ends included.
struct AxisLines {
  crossing_internal::Span a, b;
};

namespace axis_internal {

using crossing_internal::CeilDiv;
using crossing_internal::FloorDiv;
using crossing_internal::Span;
using Vec3l = Vec<int64_t, 3>;

// An edge of the projected triangle, counter-clockwise. With U = 2^kUnitBits, the line (a, b) is on its inner side iff
//   dx * (b*U - y) - dy * (a*U - x) + tie - 1 >= 0,   which is dy * a <= floor((dx * (b*U - y) + dy * x + tie - 1) /
//   U).
template <int kUnitBits>
struct AxisEdge {
  int64_t x, y, dx, dy, tie;

  //   m0, m1   the axes of x and y
  AxisEdge(const Vec3l& from, const Vec3l& to, size_t m0, size_t m1)
      : x(from[0]), y(from[1]), dx(to[0] - from[0]), dy(to[1] - from[1]), tie(0) {
    Vec3l shift{};
    shift[m0] = dy;
    shift[m1] = -dx;
    tie = FirstNonzeroIsPositive(shift) ? 1 : 0;
  }

  void Clip(int64_t b, Span& span) const {
    const int64_t room = (dx * (b * (int64_t{1} << kUnitBits) - y) + dy * x + tie - 1) >> kUnitBits;
    if (dy > 0) {
      span.last = std::min(span.last, FloorDiv(room, dy));
    } else if (dy < 0) {
      span.first = std::max(span.first, CeilDiv(-room, -dy));
    } else if (room < 0) {
      span.last = span.first - 1;
    }
  }
};

}  // namespace axis_internal

// Calls f(a, b, above, turn) for each line along the axis that the triangle crosses. The lines belong to the lattice of
// all multiples of 2^kUnitBits lattice units:
//   above   the lowest point of the line above the crossing
//   turn    the change of the winding number on the way up through the triangle: +1 against its normal, else -1
template <int kUnitBits, class F>
void ForEachAxisCrossing(const Triangle& triangle, size_t axis, const AxisLines& lines, F&& f) {
  using namespace axis_internal;
  using Wide = __int128;
  constexpr int64_t kUnit = int64_t{1} << kUnitBits;
  const size_t m0 = (axis + 1) % 3, m1 = (axis + 2) % 3;
  const auto range = [&](size_t m, const Span& within) {
    const auto [low, high] = std::minmax({triangle[0][m], triangle[1][m], triangle[2][m]});
    return Span{std::max((low + kUnit - 1) >> kUnitBits, within.first),
                std::min(int64_t{high} >> kUnitBits, within.last)};
  };
  const Span a = range(m0, lines.a);
  if (a.first > a.last) return;
  const Span b = range(m1, lines.b);
  if (b.first > b.last) return;

  // As in ForEachCrossing, for the frame whose rows are the axes, so many of its terms vanish.
  std::array<Vec3l, 3> v;
  for (size_t n = 0; n < 3; ++n) v[n] = {triangle[n][m0], triangle[n][m1], triangle[n][axis]};
  Vec3l normal = Cross(v[1] - v[0], v[2] - v[0]);
  if (normal[2] == 0) return;
  const int32_t turn = normal[2] < 0 ? 1 : -1;
  if (normal[2] < 0) {
    std::swap(v[1], v[2]);
    normal = -normal;
  }
  Vec3l normal_ijk;
  normal_ijk[m0] = normal[0];
  normal_ijk[m1] = normal[1];
  normal_ijk[axis] = normal[2];
  const int64_t tie = FirstNonzeroIsPositive(normal_ijk) ? 0 : 1, along = normal[2];
  const AxisEdge<kUnitBits> edges[3] = {{v[0], v[1], m0, m1}, {v[1], v[2], m0, m1}, {v[2], v[0], m0, m1}};

  // The depth is floor(numerator / (along * unit)). The numerators of all lines are equal modulo the unit. So, as in
  // core/scan/line_scan.h, a division of the numerators by the unit first changes nothing, and leaves numbers of 64
  // bits.
  const int64_t step = FloorDiv(-normal[0], along), step_remainder = -normal[0] - step * along;
  for (int64_t row = b.first; row <= b.last; ++row) {
    Span span = a;
    for (const auto& edge : edges) edge.Clip(row, span);
    if (span.first > span.last) continue;
    const Wide numerator = Wide{v[0][2]} * along - Wide{normal[0]} * (span.first * kUnit - v[0][0]) -
                           Wide{normal[1]} * (row * kUnit - v[0][1]) - tie;
    crossing_internal::Division depth = crossing_internal::FloorDivision(numerator >> kUnitBits, along);
    for (int64_t line = span.first; line <= span.last; ++line) {
      f(static_cast<int32_t>(line), static_cast<int32_t>(row), static_cast<int32_t>(depth.quotient) + 1, turn);
      depth.quotient += step;
      depth.remainder += step_remainder;
      if (depth.remainder >= along) {
        depth.remainder -= along;
        ++depth.quotient;
      }
    }
  }
}

}  // namespace latvox

#endif  // LATVOX_CORE_SOLID_AXIS_CROSSING_H_
