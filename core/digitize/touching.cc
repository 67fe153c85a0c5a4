// Triangles in the lanes, form after form.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/digitize/touching.cc"
#include "core/digitize/touching.h"

#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <utility>

#include "core/snap/corner_list-inl.h"

namespace latvox {
#ifndef LATVOX_CORE_DIGITIZE_TOUCHING_CC_ONCE
#define LATVOX_CORE_DIGITIZE_TOUCHING_CC_ONCE
namespace {

bool Touches(const LineForms& forms, const std::array<Vec3i, 3>& v) {
  std::array<bool, kMaxForms> between{};
  for (size_t n = 0; n < forms.between; ++n) {
    const auto floor = [&](size_t corner) { return Dot(forms.forms[n], v[corner]) >> kSubvoxelBits; };
    between[n] = floor(0) != floor(1) || floor(0) != floor(2);
  }
  return std::any_of(forms.of_frame.begin(), forms.of_frame.end(),
                     [&](const auto& frame) { return between[frame.form[0]] && between[frame.form[1]]; });
}

void KeepPlain(const LineForms& forms, CornerList& list) {
  const size_t count = std::exchange(list.size, 0);
  for (size_t n = 0; n < count; ++n) {
    if (Touches(forms, {list.Corner(0, n), list.Corner(1, n), list.Corner(2, n)})) list.Keep(n);
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
  const Lanes d;
  const size_t count = std::exchange(list.size, 0);
  for (size_t first = 0; first < count; first += kTriangleLanes) {
    const std::array<Ints3, 3> v = LoadCorners(list, first);
    // A bit for each form between whose floors at the corners there is a difference.
    Ints between = hn::Zero(d);
    for (size_t n = 0; n < forms.between; ++n) {
      const Ints3 value = ValuesOf(d, forms.forms[n], v);
      const Ints differs = hn::Or(hn::Xor(value[0], value[1]), hn::Xor(value[0], value[2]));
      const auto same_floor = hn::Eq(hn::ShiftRight<kSubvoxelBits>(differs), hn::Zero(d));
      between = hn::Or(between, hn::IfThenZeroElse(same_floor, Fill(1 << n)));
    }
    auto touches = hn::FirstN(d, 0);
    for (const auto& frame : forms.of_frame) {
      const Ints both = Fill(1 << frame.form[0] | 1 << frame.form[1]);
      touches = hn::Or(touches, hn::Eq(hn::And(between, both), both));
    }
    uint64_t bits = 0;
    hn::StoreMaskBits(d, hn::And(touches, hn::FirstN(d, count - first)), reinterpret_cast<uint8_t*>(&bits));
    for (; bits != 0; bits &= bits - 1) list.Keep(first + static_cast<size_t>(std::countr_zero(bits)));
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
