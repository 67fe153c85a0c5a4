// Triangles in lanes, form after form.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/tiny/touching.cc"
#include "core/tiny/touching.h"

#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <utility>

#include "core/triangles/corner_list-inl.h"

namespace latvox {
#ifndef LATVOX_CORE_DIGITIZE_TOUCHING_CC_ONCE
#define LATVOX_CORE_DIGITIZE_TOUCHING_CC_ONCE
namespace {

bool Touches(const LineForms& forms, const CornerList& list, size_t place) {
  if (!list.IsNear(place)) return true;
  std::array<bool, kMaxForms> between{};
  for (size_t n = 0; n < forms.between; ++n) {
    const auto floor = [&](size_t corner) { return Dot(forms.forms[n], list.Corner(corner, place)) >> kSubvoxelBits; };
    between[n] = floor(0) != floor(1) || floor(0) != floor(2);
  }
  return std::any_of(forms.of_frame.begin(), forms.of_frame.end(),
                     [&](const auto& frame) { return between[frame.form[0]] && between[frame.form[1]]; });
}

void KeepPlain(const LineForms& forms, CornerList& list) {
  const size_t count = std::exchange(list.size, 0);
  for (size_t n = 0; n < count; ++n) {
    if (Touches(forms, list, n)) list.Keep(n);
  }
}

}  // namespace
#endif
}  // namespace latvox

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET == HWY_SCALAR
void KeepInLanes(const LineForms& forms, CornerList& list) { KeepPlain(forms, list); }
#else

namespace hn = hwy::HWY_NAMESPACE;

void KeepInLanes(const LineForms& forms, CornerList& list) {
  const hn::ScalableTag<int16_t> d;
  using ShortMask = hn::Mask<decltype(d)>;
  const size_t count = std::exchange(list.size, 0);
  const auto place_of = StoredOrder(d);
  const LaneOrder in_order(d, place_of);
  for (size_t first = 0; first < count; first += hn::Lanes(d)) {
    const auto v = LoadStored(d, list, first);
    ShortMask between[kMaxForms];  // for each form, whether its floors at the corners differ
    for (size_t n = 0; n < forms.between; ++n) {
      const auto value = ValuesOf(d, forms.forms[n], v);
      const auto differs = hn::Or(hn::Xor(value[0], value[1]), hn::Xor(value[0], value[2]));
      between[n] = hn::Ne(hn::ShiftRight<kSubvoxelBits>(differs), hn::Zero(d));
    }
    auto touches = hn::Not(AreNear(d, v));
    for (const auto& frame : forms.of_frame) {
      touches = hn::Or(touches, hn::And(between[frame.form[0]], between[frame.form[1]]));
    }
    const auto given = hn::Lt(place_of, hn::Set(d, static_cast<int16_t>(count - first)));
    for (uint64_t bits = in_order(hn::And(touches, given)); bits != 0; bits &= bits - 1) {
      list.Keep(first + static_cast<size_t>(std::countr_zero(bits)));
    }
  }
}

#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "core/base/simd.h"

namespace latvox {
namespace {

HWY_EXPORT(KeepInLanes);

}  // namespace

void KeepTouching(const LineForms& forms, CornerList& triangles) {
  SimdIsScalar() ? KeepPlain(forms, triangles) : HWY_DYNAMIC_DISPATCH(KeepInLanes)(forms, triangles);
}

}  // namespace latvox
#endif  // HWY_ONCE
