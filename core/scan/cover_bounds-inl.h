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

// Which lines of a supercover may have a second voxel. Let h be the largest n.x over the cell, and C the principal
// direction. The cells of a line that meet the plane have voxels within h of it. Half of C lies in the cell,
// so h is at least n.C/2. The first such voxel is the nearest one, z. As h < n.C (core/supercover/near_cells.h), there
// is at most a second one: z's other neighbor along the line on the plane's side. If the plane is at d from z, |d| <=
// n.C/2, it is at n.C - |d| from the second, which is at most h iff |d| >= n.C - h. With the remainder r of
// core/scan/line_scan.h, d = r - n.C/2, less than 2 away. So the second voxel may exist only if
//   |2r - n.C| > 2(n.C - h) - 8
// Floats find the right side. Let M be the sum of |n_m step_m| over steps and axes. The roundings in 2 h parts are less
// than M * 2^-20, and the others less than n.C * 2^-15. Both are added.
HWY_INLINE Ints SecondVoxel(const CellSegments& cell, const Ints3& normal, Ints along) {
  const hn::RebindToFloat<Lanes> df;
  const auto to_float = [&](Ints i) HWY_ATTR { return hn::ConvertTo(df, i); };
  const auto n_0 = to_float(normal[0]), n_1 = to_float(normal[1]), n_2 = to_float(normal[2]);
  auto twice_h = hn::Zero(df), magnitude = twice_h;
  for (const Vec3i& step : cell.steps) {
    const auto entry = [&](size_t m) HWY_ATTR { return hn::Set(df, static_cast<float>(step[m])); };
    const auto over = hn::MulAdd(n_0, entry(0), hn::MulAdd(n_1, entry(1), hn::Mul(n_2, entry(2))));
    twice_h = hn::Add(twice_h, hn::Abs(over));
    const auto entry_size = [&](size_t m) HWY_ATTR { return hn::Abs(entry(m)); };
    magnitude = hn::MulAdd(hn::Abs(n_0), entry_size(0), magnitude);
    magnitude = hn::MulAdd(hn::Abs(n_1), entry_size(1), hn::MulAdd(hn::Abs(n_2), entry_size(2), magnitude));
  }
  twice_h = hn::MulAdd(magnitude, hn::Set(df, 0x1p-20F), twice_h);
  const auto room = hn::Mul(to_float(along), hn::Set(df, 2 - 0x1p-15F));
  const auto reach = hn::MulAdd(twice_h, hn::Set(df, 1.0F / static_cast<float>(cell.parts)), hn::Set(df, 9.0F));
  return hn::ConvertTo(Lanes(), hn::Sub(room, reach));
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#endif
