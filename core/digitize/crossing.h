// The crossing rule: where one triangle crosses the lattice lines along one direction.
//
// A lattice link is a segment z -> z+q between k-neighbors. The voxels of a surface are the nearer ends of all links
// that it crosses. So every crossed link has an end in the set: that is k-separation, for any surface. On a plane, the
// set is exactly { z : -t < n.z + D <= t } of the thesis's Theorems 1-7.
//
// Frames (core/lattice/frame.h): a lattice line along q is the point (a, b) of the projection along q, and c counts the
// voxels on it. This is the thesis's project, scan-convert and lift (section 4.3), once per direction, and exactly.
//
// Ties. The result is that of the surface shifted by the infinitesimal (e, e^2, e^3) in lattice coordinates, the same
// for every direction (simulation of simplicity). Two triangles with a common edge never both claim, nor both miss, a
// lattice line through it. A depth halfway between two voxels takes the end at signed distance +t, for the plane's
// normal with positive first nonzero entry. The same shift moves the surface to that end.
#ifndef LATVOX_CORE_DIGITIZE_CROSSING_H_
#define LATVOX_CORE_DIGITIZE_CROSSING_H_

#include <algorithm>
#include <cstdint>
#include <utility>

#include "core/base/stop_signal.h"
#include "core/base/vec.h"
#include "core/brick/brick.h"
#include "core/lattice/frame.h"
#include "core/snap/snap.h"

namespace latvox {

using Triangle = std::array<Vec3i, 3>;  // fixed-point lattice coordinates, see core/snap/snap.h

namespace crossing_internal {

using Vec3l = Vec<int64_t, 3>;
using Wide = __int128;

// floor(n / d) for d > 0.
constexpr int64_t FloorDiv(int64_t n, int64_t d) { return n / d - (n % d < 0); }
constexpr int64_t CeilDiv(int64_t n, int64_t d) { return n / d + (n % d > 0); }

struct Division {
  int64_t quotient, remainder;
};

// n = quotient * d + remainder, 0 <= remainder < d. Most numerators fit 64 bits, where dividing is much cheaper.
constexpr Division FloorDivision(Wide n, int64_t d) {
  if (n == static_cast<int64_t>(n)) {
    const auto narrow = static_cast<int64_t>(n);
    const int64_t q = narrow / d, r = narrow % d;  // the floor times d may not fit
    return r < 0 ? Division{q - 1, r + d} : Division{q, r};
  }
  const Wide q = n / d - (n % d < 0);
  return {static_cast<int64_t>(q), static_cast<int64_t>(n - q * d)};
}

// The lines a = first .. last of one row.
struct Span {
  int64_t first, last;
};

// One edge of the projected triangle, counter-clockwise from (x, y). The line (a, b) is on its inner side iff
//   dx * (Y - y) - dy * (X - x) + tie > 0,   X = a * kLatticeUnit, Y = b * kLatticeUnit.
// The tie is 1 if the shift makes an edge function of 0 positive, else 0. The shift moves (x, y) by (R0.s, R1.s),
// s = (e, e^2, e^3), so it changes the edge function by sum_m s_m * (dy*R0[m] - dx*R1[m]).
struct ProjectedEdge {
  int64_t x, y, dx, dy, tie;

  ProjectedEdge(const Frame& frame, int64_t x0, int64_t y0, int64_t x1, int64_t y1)
      : x(x0), y(y0), dx(x1 - x0), dy(y1 - y0), tie(0) {
    Vec3l shift;
    for (size_t m = 0; m < 3; ++m) shift[m] = dy * frame.r[0][m] - dx * frame.r[1][m];
    tie = FirstNonzeroIsPositive(shift) ? 1 : 0;
  }

  // Removes the part of row b that is not inside.
  void Clip(int64_t b, Span& span) const {
    // Inside iff step * a <= room.
    const int64_t step = dy * kLatticeUnit;
    const int64_t room = dx * (b * kLatticeUnit - y) + dy * x + tie - 1;
    if (step > 0) {
      span.last = std::min(span.last, FloorDiv(room, step));
    } else if (step < 0) {
      span.first = std::max(span.first, CeilDiv(-room, -step));
    } else if (room < 0) {
      span.last = span.first - 1;
    }
  }
};

// Returns the least and the largest value of row . ijk over the voxels of the box.
inline Span RangeOver(const IndexBox& box, const Vec3i& row) {
  Span span{0, 0};
  for (size_t m = 0; m < 3; ++m) {
    const int64_t low = int64_t{row[m]} * box.min[m], high = int64_t{row[m]} * (box.max[m] - 1);
    span.first += std::min(low, high);
    span.last += std::max(low, high);
  }
  return span;
}

}  // namespace crossing_internal

// Calls emit(nearer, farther) with the two ends of every lattice link along frame.q that the triangle crosses and that
// has its nearer end in `box` (local voxels). A triangle parallel to q crosses none. Returns early once cancelled.
template <class Emit>
void ForEachCrossing(const Triangle& triangle, const Frame& frame, const IndexBox& box, Emit&& emit,
                     StopSignal stop = {}) {
  using namespace crossing_internal;
  std::array<Vec3l, 3> v;
  for (size_t n = 0; n < 3; ++n) v[n] = {triangle[n][0], triangle[n][1], triangle[n][2]};

  // Counter-clockwise in the projection: then the normal points along q.
  Vec3l normal = Cross(v[1] - v[0], v[2] - v[0]);
  int64_t along = Dot(normal, frame.q);
  if (along == 0) return;
  if (along < 0) {
    std::swap(v[1], v[2]);
    normal = -normal;
    along = -along;
  }
  std::array<int64_t, 3> x, y;
  for (size_t n = 0; n < 3; ++n) {
    x[n] = Dot(frame.r[0], v[n]);
    y[n] = Dot(frame.r[1], v[n]);
  }

  // Lines that both the triangle and the box may meet.
  const auto [x_min, x_max] = std::minmax({x[0], x[1], x[2]});
  const auto [y_min, y_max] = std::minmax({y[0], y[1], y[2]});
  const Span box_a = RangeOver(box, frame.r[0]), box_b = RangeOver(box, frame.r[1]);
  const Span a{std::max(CeilDiv(x_min, kLatticeUnit), box_a.first),
               std::min(FloorDiv(x_max, kLatticeUnit), box_a.last)};
  const Span b{std::max(CeilDiv(y_min, kLatticeUnit), box_b.first),
               std::min(FloorDiv(y_max, kLatticeUnit), box_b.last)};
  if (a.first > a.last || b.first > b.last) return;

  const ProjectedEdge edges[3] = {
      {frame, x[0], y[0], x[1], y[1]}, {frame, x[1], y[1], x[2], y[2]}, {frame, x[2], y[2], x[0], y[0]}};

  // The plane in the frame: n_a (X-x0) + n_b (Y-y0) + along (Z-z0) = 0. A depth Z rounds to c = floor((Z + half) /
  // unit) = floor(numerator / denominator); a tie that the shift moves down must not reach the next multiple.
  const int64_t z0 = Dot(frame.r[2], v[0]);
  const int64_t n_a = Dot(normal, frame.u[0]), n_b = Dot(normal, frame.u[1]);
  const bool shift_up = FirstNonzeroIsPositive(normal);
  const int64_t denominator = along * kLatticeUnit;
  const Division step = FloorDivision(-Wide{n_a} * kLatticeUnit, denominator);

  for (int64_t row = b.first; row <= b.last && !stop.Stopped(); ++row) {
    Span span = a;
    for (const ProjectedEdge& edge : edges) edge.Clip(row, span);
    if (span.first > span.last) continue;

    const Wide numerator = Wide{z0 + kLatticeUnit / 2} * along - Wide{n_a} * (span.first * kLatticeUnit - x[0]) -
                           Wide{n_b} * (row * kLatticeUnit - y[0]) - (shift_up ? 0 : 1);
    Division depth = FloorDivision(numerator, denominator);
    Vec3i nearer;
    for (size_t m = 0; m < 3; ++m) {
      nearer[m] = static_cast<int32_t>(span.first * frame.u[0][m] + row * frame.u[1][m]);
    }
    for (int64_t line = span.first; line <= span.last; ++line) {
      const auto c = static_cast<int32_t>(depth.quotient);
      const Vec3i z = nearer + frame.q * c;
      // The surface lies above z iff the remainder is at least half; exactly half is on z, and moves by the shift,
      // which the numerator holds already.
      if (box.Contains(z)) emit(z, depth.remainder >= denominator / 2 ? z + frame.q : z - frame.q);
      nearer = nearer + frame.u[0];
      depth.quotient += step.quotient;
      depth.remainder += step.remainder;
      if (depth.remainder >= denominator) {
        depth.remainder -= denominator;
        ++depth.quotient;
      }
    }
  }
}

}  // namespace latvox

#endif  // LATVOX_CORE_DIGITIZE_CROSSING_H_
