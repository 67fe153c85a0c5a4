// The positions of voxels in lanes, from their numbers.
#if defined(LATVOX_CORE_TRIANGLES_POSITIONS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LATVOX_CORE_TRIANGLES_POSITIONS_INL_H_
#undef LATVOX_CORE_TRIANGLES_POSITIONS_INL_H_
#else
#define LATVOX_CORE_TRIANGLES_POSITIONS_INL_H_
#endif

#include <hwy/highway.h>

#include "core/snap/snap.h"
#include "core/triangles/triangle_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET != HWY_SCALAR

namespace hn = hwy::HWY_NAMESPACE;

// Returns floor(n / by), for 0 <= n < 2^24. A float holds n, so its quotient is at most one off.
HWY_INLINE Ints QuotientOf(Ints n, int32_t by) {
  const Lanes d;
  const hn::ScalableTag<float> floats;
  const auto reciprocal = hn::Set(floats, 1.0F / static_cast<float>(by));
  const Ints near = hn::ConvertTo(d, hn::Mul(hn::ConvertTo(floats, n), reciprocal));
  const Ints rest = hn::Sub(n, hn::Mul(near, Fill(by)));
  const Ints below = hn::VecFromMask(d, hn::Lt(rest, hn::Zero(d)));
  const Ints above = hn::VecFromMask(d, hn::Gt(rest, Fill(by - 1)));
  return hn::Add(near, hn::Sub(below, above));
}

// Returns the positions of voxels in lattice units, by axis.
//   Layout   core/tile has it; this room does not see it
template <class Layout>
HWY_INLINE Ints3 PositionsOf(const Layout& layout, Ints voxels) {
  const Ints i = QuotientOf(voxels, layout.stride[0]), row = QuotientOf(voxels, layout.stride[1]);
  const Ints3 in_box{i, hn::Sub(row, hn::Mul(i, Fill(layout.side[1]))),
                     hn::Sub(voxels, hn::Mul(row, Fill(layout.stride[1])))};
  const auto position = [&](size_t m) HWY_ATTR {
    return hn::ShiftLeft<kSubvoxelBits>(hn::Add(in_box[m], Fill(layout.origin[m])));
  };
  return {position(0), position(1), position(2)};
}

#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#endif
