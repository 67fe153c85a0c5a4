#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/supercover/row_bounds.cc"
#include "core/supercover/row_bounds.h"

#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "core/supercover/row_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

void FindInLanes(const RowBounds::Sides& sides, double i, double j, size_t count, const Interval& all,
                 RowBounds::Rows& out) {
  FindRows(sides, i, j, count, all, out);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace latvox {
namespace {

HWY_EXPORT(FindInLanes);

}  // namespace

void RowBounds::Find(int32_t i, int32_t j, int32_t count, const Interval& all, Rows& out) const {
  HWY_DYNAMIC_DISPATCH(FindInLanes)(sides_, i, j, static_cast<size_t>(count), all, out);
}

}  // namespace latvox
#endif  // HWY_ONCE
