// All voxels that one triangle may contribute, from one scan along its principal direction.
//
// Let C be the principal direction, the q with the largest |n.q|, and t = |n.C|/2. Every nearer end z of a crossed link
// along any q has -t < d(z) <= t, because the distance between the plane and the link's ends is at most |n.q| <= 2t.
// Exactly one voxel of each lattice line along C has that property (Theorems 1-7). So z is the voxel of its line along
// C that is nearest to the plane. Its line need not meet the triangle, but passes it closely: z + s q lies on the
// triangle, |s| <= 1/2. So in the projection along C, the edge function e_m of the line is at least -max_q |L_m(q)|/2,
// with L_m the linear part of e_m.
//
// Lines that meet the triangle give voxels at once (they are crossed along C). The others, the rim, give candidates,
// whose star (core/digitize/star.h) decides. On a smooth surface a neighboring triangle has set them already.
#ifndef LATVOX_CORE_DIGITIZE_PRINCIPAL_SCAN_H_
#define LATVOX_CORE_DIGITIZE_PRINCIPAL_SCAN_H_

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "core/digitize/crossing.h"
#include "core/digitize/star.h"

namespace latvox {

inline constexpr size_t kMaxDirections = 16;       // a power of two, for lanes
inline constexpr size_t kMaxHull = kMaxPairs - 1;  // all other pairs
static_assert(kMaxPairs <= kMaxDirections);

// A frame with the data for its rim: all neighbors q in the projection along frame.q.
struct ScanFrame {
  Frame frame;
  std::vector<Vec<int64_t, 2>> hull;  // corners of their convex hull, one of each pair +-; at most kMaxHull
  int64_t reach_a, reach_b;           // its extent along both axes
};

// Returns one for each frame, those with small q first. Where planes are parallel to a lattice plane, |n.q| is the
// largest for several directions. The first of them is the smallest, and has the narrowest rim.
std::vector<ScanFrame> MakeScanFrames(const std::vector<Frame>& frames);

// The first with the largest |normal . q|. Precondition: frames is not empty.
const ScanFrame& PrincipalScanFrame(const std::vector<ScanFrame>& frames, const Vec<int64_t, 3>& normal);

namespace scan_internal {

using crossing_internal::RangeOver;
using crossing_internal::Span;
using Vec3l = Vec<int64_t, 3>;

// floor(n / d), d > 0, from a reciprocal of d. The estimate is wrong by at most one: |n| < 2^57 and |n / d| < 2^50.
inline int64_t FloorDiv(int64_t n, int64_t d, double reciprocal) {
  auto q = static_cast<int64_t>(static_cast<double>(n) * reciprocal);
  int64_t r = n - q * d;
  while (r < 0) {
    --q;
    r += d;
  }
  while (r >= d) {
    ++q;
    r -= d;
  }
  return q;
}

// An edge of the projected triangle, and the line parallel to it that bounds the rim.
class RimmedEdge {
 public:
  RimmedEdge(const ScanFrame& scan, int64_t x0, int64_t y0, int64_t x1, int64_t y1)
      : edge_(scan.frame, x0, y0, x1, y1), step_(edge_.dy * kLatticeUnit) {
    for (const auto& q : scan.hull) rim_ = std::max(rim_, std::abs(edge_.dx * q[1] - edge_.dy * q[0]));
    rim_ *= kLatticeUnit / 2;
    if (step_ != 0) reciprocal_ = 1.0 / static_cast<double>(std::abs(step_));
  }

  // Removes the part outside of the triangle from `inner`, and the part beyond the rim from `outer`.
  void Clip(int64_t b, Span& inner, Span& outer) const {
    const int64_t room = edge_.dx * (b * kLatticeUnit - edge_.y) + edge_.dy * edge_.x;
    Cut(room + edge_.tie - 1, inner);
    Cut(room + rim_, outer);
  }

 private:
  // Keeps step * a <= room.
  void Cut(int64_t room, Span& span) const {
    if (step_ > 0) {
      span.last = std::min(span.last, FloorDiv(room, step_, reciprocal_));
    } else if (step_ < 0) {
      span.first = std::max(span.first, -FloorDiv(room, -step_, reciprocal_));
    } else if (room < 0) {
      span.last = span.first - 1;
    }
  }

  crossing_internal::ProjectedEdge edge_;
  int64_t step_, rim_ = 0;
  double reciprocal_ = 0;
};

// floor(n / d) and the remainder, for n of any size. Only the low 64 bits of n are given, and an estimate of the
// quotient that is wrong by less than one.
inline crossing_internal::Division Correct(uint64_t n, double estimate, int64_t d) {
  auto q = static_cast<int64_t>(estimate);
  auto r = static_cast<int64_t>(n - static_cast<uint64_t>(q) * static_cast<uint64_t>(d));
  while (r < 0) {
    --q;
    r += d;
  }
  while (r >= d) {
    ++q;
    r -= d;
  }
  return {q, r};
}

}  // namespace scan_internal

// Calls inner(nearer, farther) for the link along C that the triangle crosses on each lattice line. Calls rim(z) for
// the candidate on each line of the rim. Both only with nearer and z in `box` (local voxels). Precondition:
// triangle.normal is not 0, and scan is the frame of the principal direction.
template <class Inner, class Rim>
void ScanAlongPrincipal(const OrientedTriangle& triangle, const ScanFrame& scan, const IndexBox& box, Inner&& inner,
                        Rim&& rim) {
  using namespace scan_internal;
  using crossing_internal::Division;
  const Frame& frame = scan.frame;
  const int64_t up = Dot(triangle.normal, frame.q);
  // Counter-clockwise in the projection: the normal must point along q.
  const bool flip = up < 0;
  const int64_t along = flip ? -up : up;
  const std::array<const Vec3l*, 3> v{&triangle.v[0], &triangle.v[flip ? 2 : 1], &triangle.v[flip ? 1 : 2]};
  std::array<int64_t, 3> x, y;
  for (size_t n = 0; n < 3; ++n) {
    x[n] = Dot(frame.r[0], *v[n]);
    y[n] = Dot(frame.r[1], *v[n]);
  }
  constexpr int64_t kHalf = kLatticeUnit / 2;
  const auto lines = [](int64_t x0, int64_t x1, int64_t x2, int64_t reach, const Span& within) {
    const auto [low, high] = std::minmax({x0, x1, x2});
    return Span{std::max((low - reach * kHalf + kLatticeUnit - 1) >> kSubvoxelBits, within.first),
                std::min((high + reach * kHalf) >> kSubvoxelBits, within.last)};
  };
  const Span a = lines(x[0], x[1], x[2], scan.reach_a, RangeOver(box, frame.r[0]));
  const Span b = lines(y[0], y[1], y[2], scan.reach_b, RangeOver(box, frame.r[1]));
  if (a.first > a.last || b.first > b.last) return;

  const RimmedEdge edges[3] = {
      {scan, x[0], y[0], x[1], y[1]}, {scan, x[1], y[1], x[2], y[2]}, {scan, x[2], y[2], x[0], y[0]}};

  // As in ForEachCrossing; remainders are computed modulo 2^64, which holds them.
  const int64_t sign = flip ? -1 : 1;
  const int64_t n_a = sign * Dot(triangle.normal, frame.u[0]), n_b = sign * Dot(triangle.normal, frame.u[1]);
  const int64_t z0 = Dot(frame.r[2], *v[0]);
  const int64_t denominator = along * kLatticeUnit;
  const double slope_a = -static_cast<double>(n_a) / static_cast<double>(along);
  const double slope_b = -static_cast<double>(n_b) / static_cast<double>(along);
  const auto low = [](int64_t p, int64_t q) { return static_cast<uint64_t>(p) * static_cast<uint64_t>(q); };
  const Division step = Correct(low(-n_a, kLatticeUnit), slope_a, denominator);

  for (int64_t row = b.first; row <= b.last; ++row) {
    Span in = a, out = a;
    for (const RimmedEdge& edge : edges) edge.Clip(row, in, out);
    if (out.first > out.last) continue;

    const int64_t from_x = out.first * kLatticeUnit - x[0], from_y = row * kLatticeUnit - y[0];
    const uint64_t numerator =
        low(z0 + kHalf, along) - low(n_a, from_x) - low(n_b, from_y) - static_cast<uint64_t>(flip ? 1 : 0);
    const double estimate = (static_cast<double>(z0 + kHalf) + slope_a * static_cast<double>(from_x) +
                             slope_b * static_cast<double>(from_y)) /
                            kLatticeUnit;
    Division depth = Correct(numerator, estimate, denominator);
    Vec3i on_line;
    for (size_t m = 0; m < 3; ++m) {
      on_line[m] = static_cast<int32_t>(out.first * frame.u[0][m] + row * frame.u[1][m]);
    }
    for (int64_t line = out.first; line <= out.last; ++line) {
      const Vec3i z = on_line + frame.q * static_cast<int32_t>(depth.quotient);
      if (box.Contains(z)) {
        if (in.first <= line && line <= in.last) {
          inner(z, depth.remainder >= denominator / 2 ? z + frame.q : z - frame.q);
        } else {
          rim(z);
        }
      }
      on_line = on_line + frame.u[0];
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

#endif  // LATVOX_CORE_DIGITIZE_PRINCIPAL_SCAN_H_
