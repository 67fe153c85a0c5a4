// The crossing rule in the plane: where one segment crosses the lattice lines along one direction.
//
// A link is a segment z -> z+q between k-neighbors. The pixels of a curve are the nearer ends of all links that it
// crosses. So every crossed link has an end in the set: that is k-separation, for any curve. On a line the set is
// exactly { z : -t < n.z + D <= t } of the thesis's Theorems 1 (any lattice), 2 and 3 (square).
//
// This is the rule of core/digitize/crossing.h with one dimension less, but not an instance of it. There a triangle
// covers a span of lines in each row. Here a segment meets each line of one range once, and 64 bits hold every depth.
// The exact divisions are shared.
//
// Ties. The result is that of the curve shifted by the infinitesimal (e, e^2) in lattice coordinates, the same for
// every direction (simulation of simplicity). Exactly one of two segments with a common end claims a lattice line
// through it that the curve crosses there. So a closed curve crosses every lattice line an even number of times. A
// depth halfway between two pixels takes the end at signed distance +t, for the normal with positive first nonzero
// entry. The same shift moves the curve to that end. Theorem 3 is closed at both ends in the thesis, which is
// separating but, with ties, not minimal; here it is half open like Theorems 1 and 2.
#ifndef LATVOX_CORE_PLANE_CROSSING2_H_
#define LATVOX_CORE_PLANE_CROSSING2_H_

#include <cstdint>
#include <utility>

#include "core/digitize/crossing.h"
#include "core/lattice/frame.h"
#include "core/plane/polyline.h"

namespace latvox {

// A segment in a frame: it runs from (x0, z0) to (x1, z1), x0 <= x1, in units of 1/kLatticeUnit; x is across the
// lattice lines, z along them.
struct FramedSegment {
  int64_t x0, z0, x1, z1;
  bool shift_up;  // whether the shift moves the segment's line along +q

  FramedSegment(const Segment& segment, const PlaneFrame& frame)
      : x0(Dot(frame.r[0], Wide(segment.a_lat))),
        z0(Dot(frame.r[1], Wide(segment.a_lat))),
        x1(Dot(frame.r[0], Wide(segment.b_lat))),
        z1(Dot(frame.r[1], Wide(segment.b_lat))) {
    Vec2l d = Wide(segment.b_lat) - Wide(segment.a_lat);
    if (x0 > x1) {
      std::swap(x0, x1);
      std::swap(z0, z1);
      d = -d;
    }
    // The normal along q: its product with q is r[0].d = x1 - x0.
    shift_up = FirstNonzeroIsPositive(Vec2l{-d[1], d[0]});
  }

  bool IsParallelToLines() const { return x0 == x1; }

 private:
  static Vec2l Wide(const Vec2i& v) { return {v[0], v[1]}; }
};

// Walks along a segment's infinite line, from one lattice line along q to the next, and knows the nearest pixel on
// each. This is the thesis's incremental lift (section 4.4: k += delta k), as an exact integer DDA.
class LineWalk {
 public:
  // Starts on the lattice line a. Precondition: !segment.IsParallelToLines().
  LineWalk(const FramedSegment& segment, const PlaneFrame& frame, int64_t a) : frame_(frame) {
    using crossing_internal::FloorDiv;
    const int64_t across = segment.x1 - segment.x0, along = segment.z1 - segment.z0;
    denominator_ = across * kLatticeUnit;
    // A depth Z rounds to c = floor((Z + half) / unit) = floor(numerator / denominator); a tie that the shift moves
    // down must not reach the next multiple.
    const int64_t numerator =
        (segment.z0 + kLatticeUnit / 2) * across + along * (a * kLatticeUnit - segment.x0) - (segment.shift_up ? 0 : 1);
    c_ = FloorDiv(numerator, denominator_);
    remainder_ = numerator - c_ * denominator_;
    c_step_ = FloorDiv(along, across);
    remainder_step_ = (along - c_step_ * across) * kLatticeUnit;
    for (size_t m = 0; m < 2; ++m) on_line_[m] = static_cast<int32_t>(a * frame.u[0][m]);
  }

  // The pixel nearest to the curve on the current lattice line, and the other end of the link that the curve crosses.
  Vec2i nearer() const { return on_line_ + frame_.q * static_cast<int32_t>(c_); }
  // The curve lies above the nearer end iff the remainder is at least half; exactly half is on it, and moves by the
  // shift, which the numerator holds already.
  Vec2i farther() const { return remainder_ >= denominator_ / 2 ? nearer() + frame_.q : nearer() - frame_.q; }

  void Next() {
    on_line_ = on_line_ + frame_.u[0];
    c_ += c_step_;
    remainder_ += remainder_step_;
    if (remainder_ >= denominator_) {
      remainder_ -= denominator_;
      ++c_;
    }
  }

 private:
  const PlaneFrame& frame_;
  Vec2i on_line_;  // the current lattice line's pixel with c = 0
  int64_t denominator_, c_, remainder_, c_step_, remainder_step_;
};

// Calls emit(nearer, farther) with the two ends (local pixels) of every link along frame.q that the segment crosses. A
// segment parallel to q crosses none, and so does one of length zero.
template <class Emit>
void ForEachCrossing(const Segment& segment, const PlaneFrame& frame, Emit&& emit) {
  using crossing_internal::CeilDiv, crossing_internal::FloorDiv;
  const FramedSegment framed(segment, frame);
  if (framed.IsParallelToLines()) return;
  // The shift moves x by r[0].(e, e^2): upwards, the lines x0 < X <= x1 are met, else x0 <= X < x1.
  const int64_t up = FirstNonzeroIsPositive(frame.r[0]) ? 1 : 0;
  const int64_t first = CeilDiv(framed.x0 + up, kLatticeUnit), last = FloorDiv(framed.x1 + up - 1, kLatticeUnit);
  if (first > last) return;
  LineWalk walk(framed, frame, first);
  for (int64_t a = first; a <= last; ++a, walk.Next()) emit(walk.nearer(), walk.farther());
}

}  // namespace latvox

#endif  // LATVOX_CORE_PLANE_CROSSING2_H_
