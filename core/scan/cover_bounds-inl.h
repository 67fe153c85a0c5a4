// Bounds for the scan of a supercover, for many triangles, one for each lane.
#if defined(LATVOX_CORE_SCAN_COVER_BOUNDS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LATVOX_CORE_SCAN_COVER_BOUNDS_INL_H_
#undef LATVOX_CORE_SCAN_COVER_BOUNDS_INL_H_
#else
#define LATVOX_CORE_SCAN_COVER_BOUNDS_INL_H_
#endif

#include <hwy/highway.h>

#include "core/lattice/integer_cell.h"
#include "core/triangles/triangle_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

// The rims of a supercover: an edge function changes by as much over half of the cell's projection. The scan takes no
// line where an edge function is exactly minus the rim, so rims are one wider. One more makes up for the cut, and the
// factor for the three roundings of floats.
//   sum   of |changes| over the cell's steps
HWY_INLINE Ints CoverRim(Ints sum, int32_t parts) {
  const hn::RebindToFloat<Lanes> df;
  const auto per_step = hn::Set(df, 0.5F * (1 + 0x1p-20F) / static_cast<float>(parts));
  return hn::Add(hn::ConvertTo(Lanes(), hn::Mul(hn::ConvertTo(df, sum), per_step)), Fill(2));
}

// Where a line of a supercover has a second voxel. Let w be the corner of the cell with the largest n.w, which is h,
// and C the principal direction. The cells of a line that meet the plane have voxels within h of it. Half of C lies in
// the cell, so h is at least n.C/2. The first such voxel is the nearest one, z. As h < n.C
// (core/supercover/near_cells.h), there is at most a second one: z', z's other neighbor along the line on the plane's
// side. If the plane is at d from z, |d| <= n.C/2, it is at n.C - |d| from z', which is at most h iff |d| >= n.C - h.
// With the remainder r of core/scan/line_scan.h, d = r - n.C/2, less than 2 away. So z' may meet the plane only if the
// first of these holds, and surely does if the second one does:
//   |2r - n.C| > 2(n.C - h) - 8        |2r - n.C| > 2(n.C - h) + 8
// Then the point p = z' + s w of the plane is in the cell of z', where |s| = (n.C - |d|) / h is 1 at most, and n.C/2h
// at least. Its sign is that of d, reversed. Along C, p is seen s w beside the line. If it is within the triangle, z'
// is in the supercover. With the change W of an edge function E over w, it is inside of the edge iff E + s W >= 0. That
// holds for all such s if it holds for the smallest and the largest one. Floats find the right side. Let M be the sum
// of |n_m step_m| over steps and axes. The roundings in 2 h parts are less than M * 2^-20, and the others less than n.C
// * 2^-15. Both are added, or subtracted. A wrong sign of a small n.step costs no more: then w is another corner, where
// n.w is nearly h.
class SecondVoxels {
 public:
  HWY_INLINE SecondVoxels(const CellSegments& cell, const Ints3& normal, Ints along) : parts_(cell.parts) {
    const std::array<Floats, 3> n{ToFloats(normal[0]), ToFloats(normal[1]), ToFloats(normal[2])};
    Floats twice_h = hn::Zero(Floating()), magnitude = twice_h;
    for (size_t r = 0; r < cell.steps.size(); ++r) {
      const auto entry = [&](size_t m) HWY_ATTR { return All(static_cast<float>(cell.steps[r][m])); };
      const Floats over = hn::MulAdd(n[0], entry(0), hn::MulAdd(n[1], entry(1), hn::Mul(n[2], entry(2))));
      descends_[r] = hn::BroadcastSignBit(hn::BitCast(Lanes(), over));
      twice_h = hn::Add(twice_h, hn::Abs(over));
      const auto entry_size = [&](size_t m) HWY_ATTR { return hn::Abs(entry(m)); };
      magnitude = hn::MulAdd(hn::Abs(n[0]), entry_size(0), magnitude);
      magnitude = hn::MulAdd(hn::Abs(n[1]), entry_size(1), hn::MulAdd(hn::Abs(n[2]), entry_size(2), magnitude));
    }
    const Floats error = hn::Mul(magnitude, All(0x1p-20F)), of_along = ToFloats(along);
    const Floats per_part = All(1.0F / static_cast<float>(cell.parts));
    const auto threshold = [&](float twice, Floats twice_h_parts, float more) HWY_ATTR {
      const Floats room = hn::MulAdd(of_along, All(twice), All(more));
      return hn::ConvertTo(Lanes(), hn::Sub(room, hn::Mul(twice_h_parts, per_part)));
    };
    maybe_ = threshold(2 - 0x1p-15F, hn::Add(twice_h, error), -9);
    sure_ = threshold(2 + 0x1p-15F, hn::Sub(twice_h, error), 9);
    // |d| may be larger than n.C/2 by 2.
    const Floats room = hn::Max(hn::Sub(of_along, All(4)), hn::Zero(Floating()));
    smallest_ = hn::Div(hn::Mul(room, All(static_cast<float>(cell.parts))), hn::Add(twice_h, error));
  }

  // |2r - n.C| is larger on a line whose z' may, or surely does, meet the plane. Negative: a line may have a third
  // voxel.
  Ints maybe() const { return maybe_; }
  Ints sure() const { return sure_; }

  // Adds to `sum` what a step contributes to 2 W parts.
  //   over   the edge function's change over the step
  HWY_INLINE Ints AddStep(Ints sum, size_t step, Ints over) const {
    return hn::Add(sum, hn::Sub(hn::Xor(over, descends_[step]), descends_[step]));
  }

  // An edge function of at least this is enough where the plane is above z, and where it is below.
  struct Enough {
    Ints above, below;
  };
  //   sum   2 W parts
  HWY_INLINE Enough EnoughOf(Ints sum) const {
    const Floats w = hn::Mul(ToFloats(sum), All(0.5F / static_cast<float>(parts_))), least = hn::Mul(w, smallest_);
    const Floats slack = hn::MulAdd(hn::Abs(w), All(0x1p-18F), All(2));
    const auto enough = [&](Floats bound) HWY_ATTR { return hn::ConvertTo(Lanes(), hn::Add(bound, slack)); };
    return {enough(hn::Max(w, least)), enough(hn::Neg(hn::Min(w, least)))};
  }

 private:
  using Floating = hn::RebindToFloat<Lanes>;
  using Floats = hn::Vec<Floating>;
  static HWY_INLINE Floats ToFloats(Ints v) { return hn::ConvertTo(Floating(), v); }
  static HWY_INLINE Floats All(float x) { return hn::Set(Floating(), x); }

  int32_t parts_;
  Ints descends_[kMaxZones];  // -1: n falls along this step, so w takes minus half of it; else 0
  Ints maybe_, sure_;
  Floats smallest_;  // |s|
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#endif
