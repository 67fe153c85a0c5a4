// Rows of voxels in lanes, half-space after half-space.
#if defined(LATVOX_CORE_SUPERCOVER_ROW_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LATVOX_CORE_SUPERCOVER_ROW_LANES_INL_H_
#undef LATVOX_CORE_SUPERCOVER_ROW_LANES_INL_H_
#else
#define LATVOX_CORE_SUPERCOVER_ROW_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include "core/supercover/row_bounds.h"

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Double = hn::ScalableTag<double>;
using Doubles = hn::Vec<Double>;

// Returns the least of `start` and a side's bounds over the rows (i, j).
HWY_INLINE Doubles Least(const RowBounds::Side& side, double i, Doubles j, double start) {
  const Double d;
  Doubles least = hn::Set(d, start);
  for (size_t n = 0; n < side.size; ++n) {
    least = hn::Min(least, hn::NegMulAdd(hn::Set(d, side.j[n]), j, hn::Set(d, side.room[n] - side.i[n] * i)));
  }
  return least;
}

HWY_INLINE hn::Mask<Double> IsDoubtful(Doubles x) {
  return hn::Lt(hn::Abs(hn::Sub(x, hn::Round(x))), hn::Set(Double(), RowBounds::kDoubt));
}

// See RowBounds::Find.
HWY_INLINE void FindRows(const RowBounds::Sides& sides, double i, double j, size_t count, const Interval& all,
                         RowBounds::Rows& out) {
  const Double d;
  const hn::Rebind<int32_t, Double> ints;
  constexpr size_t kLanes = HWY_LANES(double);
  static_assert(RowBounds::kRows % kLanes == 0);
  constexpr double kFar = RowBounds::kMaxTerm * 2;
  const Doubles lowest = hn::Set(d, all.first), highest = hn::Set(d, all.last), one = hn::Set(d, 1);
  for (size_t n = 0; n < count; n += kLanes) {
    const Doubles row = hn::Iota(d, j + static_cast<double>(n));
    const Doubles most = Least(sides.upper, i, row, kFar);
    const Doubles least = hn::Neg(Least(sides.lower, i, row, kFar));
    const Doubles within = Least(sides.flat, i, row, 1);
    const Doubles first = hn::Max(hn::Ceil(least), lowest), last = hn::Min(hn::Floor(most), highest);
    const auto missed = hn::Or(hn::Lt(within, hn::Zero(d)), hn::Gt(first, hn::Add(last, one)));
    const auto cuts_last = hn::Lt(most, hn::Add(highest, one)), cuts_first = hn::Gt(least, hn::Sub(lowest, one));
    const auto doubtful =
        hn::AndNot(missed, hn::Or(hn::And(cuts_last, IsDoubtful(most)), hn::And(cuts_first, IsDoubtful(least))));
    const Doubles end = hn::IfThenElse(missed, hn::Sub(first, one), last);
    hn::StoreU(hn::DemoteTo(ints, first), ints, out.first.data() + n);
    hn::StoreU(hn::DemoteTo(ints, hn::IfThenElse(doubtful, hn::Set(d, RowBounds::kDoubtful), end)), ints,
               out.last.data() + n);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#endif  // LATVOX_CORE_SUPERCOVER_ROW_LANES_INL_H_
