// Triangles in the lanes, all directions one after the other. Few lines lie between corners, and most of these miss the
// triangle.
//
// Along q a lattice line is a point (a, b) of the projection (core/lattice/frame.h). It can only meet a triangle whose
// corners lie on both sides of a, and on both sides of b (core/digitize/touching.h). Let the corners be (x, y) relative
// to such a line: it meets the triangle iff the origin lies inside, which is to say that
//   e[n] = x[n] * y[n+1] - x[n+1] * y[n],   n = 0, 1, 2,
// all have one sign. That need not be decided where e is close to 0: whatever is let pass, TinyCrossings decides
// (core/digitize/tiny.h). So 16 bits do, and the few units that products are rounded by.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/digitize/sift.cc"
#include "core/digitize/sift.h"

#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <span>

#include "core/base/append_lanes-inl.h"
#include "core/snap/corner_list-inl.h"

namespace latvox {
#ifndef LATVOX_CORE_DIGITIZE_SIFT_CC_ONCE
#define LATVOX_CORE_DIGITIZE_SIFT_CC_ONCE
namespace {

void TakeNone(const CornerList& triangles, SiftedLines& lines, std::vector<uint32_t>& kept, uint8_t* is_tiny) {
  lines.size = 0;
  const std::span numbers(triangles.triangles, triangles.size);
  kept.insert(kept.end(), numbers.begin(), numbers.end());
  if (is_tiny == nullptr) return;
  for (const uint32_t t : numbers) is_tiny[t] = 0;
}

}  // namespace
#endif
}  // namespace latvox

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET == HWY_SCALAR
void SiftInLanes(const CornerList& triangles, const LineForms&, SiftedLines& lines, std::vector<uint32_t>& kept,
                 uint8_t* is_tiny) {
  TakeNone(triangles, lines, kept, is_tiny);
}
#else

namespace hn = hwy::HWY_NAMESPACE;

using ShortLanes = hn::ScalableTag<int16_t>;
using Shorts = hn::Vec<ShortLanes>;
using Shorts3 = std::array<Shorts, 3>;
using ShortMask = hn::Mask<ShortLanes>;
constexpr size_t kSiftLanes = 2 * kTriangleLanes;
static_assert(kSiftLanes <= SiftedLines::kSlack && kSiftLanes <= CornerList::kSlack);

// Positions are within kNearest of a voxel close to the triangle, else it is not taken for tiny; values of forms are
// sums of kMaxFrameRow of these at most.
constexpr int16_t kNearest = 16 * kLatticeUnit;
static_assert(kMaxFrameRow * kNearest < 1 << 15);

// |x|, |y| < (kMostIntegers + 1) * kLatticeUnit are given kScaleBits more, and their products lose 15 of twice that: e
// is then in units of 2^(15 - 2 * kScaleBits), off by kSlack at most. Relative to a line that does not lie between the
// corners, they may not fit, and nothing is made of it.
constexpr int kScaleBits = 5;
constexpr int16_t kSlack = 1;
static_assert((kMostIntegers + 1) * kLatticeUnit << kScaleBits < 1 << 15);

// The corners of some triangles, as the forms have them.
struct Values {
  Shorts3 relative[kMaxForms];  // of rows 0 and 1, to the last integer that is not above all of the values; scaled
  Shorts integers[kMaxForms];   // how many lie between them
  ShortMask tiny;

  HWY_INLINE Values(const LineForms& forms, const std::array<Shorts3, 3>& v) {
    const ShortLanes d;
    Shorts farthest = hn::Zero(d), most = hn::Zero(d);
    for (const Shorts3& corner : v) {
      for (const Shorts x : corner) farthest = hn::Max(farthest, hn::Max(x, hn::Not(x)));  // -x - 1, which always fits
    }
    for (size_t n = 0; n < forms.forms.size(); ++n) {
      const Shorts3 value = ValuesOf(d, forms.forms[n], v);
      const Shorts first = hn::ShiftRight<kSubvoxelBits>(hn::Min(value[0], hn::Min(value[1], value[2])));
      const Shorts last = hn::ShiftRight<kSubvoxelBits>(hn::Max(value[0], hn::Max(value[1], value[2])));
      const Shorts from = hn::ShiftLeft<kSubvoxelBits>(last);
      integers[n] = hn::Sub(last, first);
      most = hn::Max(most, integers[n]);
      if (n >= forms.between) continue;
      for (size_t c = 0; c < 3; ++c) relative[n][c] = hn::ShiftLeft<kScaleBits>(hn::Sub(value[c], from));
    }
    tiny = hn::And(hn::Lt(farthest, hn::Set(d, kNearest)), hn::Lt(most, hn::Set(d, kMostIntegers + 1)));
  }
};

// Whether the origin may be inside.
HWY_INLINE ShortMask MayMeet(const Shorts3& e) {
  const ShortLanes d;
  const Shorts least = hn::Min(e[0], hn::Min(e[1], e[2])), most = hn::Max(e[0], hn::Max(e[1], e[2]));
  return hn::Or(hn::Gt(least, hn::Set(d, -kSlack - 1)), hn::Lt(most, hn::Set(d, kSlack + 1)));
}

HWY_INLINE Shorts3 EdgesOf(const Shorts3& x, const Shorts3& y) {
  const auto edge = [&](size_t from, size_t to) HWY_ATTR {
    return hn::Sub(hn::MulFixedPoint15(x[from], y[to]), hn::MulFixedPoint15(x[to], y[from]));
  };
  return {edge(0, 1), edge(1, 2), edge(2, 0)};
}

HWY_INLINE ShortMask Exceeds(Shorts integers, int16_t n) { return hn::Gt(integers, hn::Set(ShortLanes(), n)); }

// Bit n says that the line (a, b) along direction n, as SiftedLines has it, may meet the triangle.
HWY_INLINE Shorts DirectionsOf(const LineForms& forms, const Values& values) {
  const ShortLanes d;
  Shorts directions = hn::Zero(d);
  for (size_t n = 0; n < forms.of_frame.size(); ++n) {
    const size_t a = forms.of_frame[n].form[0], b = forms.of_frame[n].form[1];
    const auto between = hn::And(Exceeds(values.integers[a], 0), Exceeds(values.integers[b], 0));
    const auto meets = hn::And(between, MayMeet(EdgesOf(values.relative[a], values.relative[b])));
    directions = hn::Or(directions, hn::IfThenElseZero(meets, hn::Set(d, static_cast<int16_t>(1 << n))));
  }
  return hn::IfThenElseZero(values.tiny, directions);
}

// The same of the other lines: (a - 1, b), (a, b - 1), (a - 1, b - 1). From line to line, e[n] gains
//   U * (y[n+1] - y[n])   and   U * (x[n] - x[n+1]).
HWY_INLINE Shorts3 MoreDirectionsOf(const LineForms& forms, const Values& values) {
  const ShortLanes d;
  const auto step = [&](const Shorts3& v, size_t from, size_t to)
                        HWY_ATTR { return hn::ShiftRight<15 - kScaleBits - kSubvoxelBits>(hn::Sub(v[to], v[from])); };
  Shorts3 directions{hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  for (size_t n = 0; n < forms.of_frame.size(); ++n) {
    const size_t a = forms.of_frame[n].form[0], b = forms.of_frame[n].form[1];
    const auto any_a = Exceeds(values.integers[a], 0), two_a = Exceeds(values.integers[a], 1);
    const auto any_b = Exceeds(values.integers[b], 0), two_b = Exceeds(values.integers[b], 1);
    if (hn::AllFalse(d, hn::And(hn::And(any_a, any_b), hn::Or(two_a, two_b)))) continue;
    const Shorts3 &x = values.relative[a], &y = values.relative[b];
    const Shorts3 e = EdgesOf(x, y);
    const Shorts3 less_a{hn::Add(e[0], step(y, 0, 1)), hn::Add(e[1], step(y, 1, 2)), hn::Add(e[2], step(y, 2, 0))};
    const Shorts3 by_b{step(x, 1, 0), step(x, 2, 1), step(x, 0, 2)};
    const Shorts3 less_b{hn::Add(e[0], by_b[0]), hn::Add(e[1], by_b[1]), hn::Add(e[2], by_b[2])};
    const Shorts3 less_both{hn::Add(less_a[0], by_b[0]), hn::Add(less_a[1], by_b[1]), hn::Add(less_a[2], by_b[2])};
    const Shorts bit = hn::Set(d, static_cast<int16_t>(1 << n));
    const auto add = [&](Shorts& to, const Shorts3& edges, ShortMask between)
                         HWY_ATTR { to = hn::Or(to, hn::IfThenElseZero(hn::And(between, MayMeet(edges)), bit)); };
    add(directions[0], less_a, hn::And(two_a, any_b));
    add(directions[1], less_b, hn::And(any_a, two_b));
    add(directions[2], less_both, hn::And(two_a, two_b));
  }
  for (Shorts& lines : directions) lines = hn::IfThenElseZero(values.tiny, lines);
  return directions;
}

// The corners of kSiftLanes triangles, by axis, relative to a voxel close to the first one; what does not fit is as far
// away as can be.
//   u, v   corners of the first half of them, and of the second
HWY_INLINE std::array<Shorts3, 3> Near(const std::array<Ints3, 3>& u, const std::array<Ints3, 3>& v) {
  const ShortLanes d;
  const hn::Half<ShortLanes> half;
  std::array<Shorts3, 3> near;
  for (size_t m = 0; m < 3; ++m) {
    const Ints fraction = Fill(kLatticeUnit - 1), from_u = hn::AndNot(fraction, u[0][m]);
    const Ints from_v = hn::AndNot(fraction, v[0][m]);
    for (size_t c = 0; c < 3; ++c) {
      near[c][m] =
          hn::Combine(d, hn::DemoteTo(half, hn::Sub(v[c][m], from_v)), hn::DemoteTo(half, hn::Sub(u[c][m], from_u)));
    }
  }
  return near;
}

// Appends, of two vectors, the lanes that the mask selects to a list.
HWY_INLINE void AppendBoth(hn::Vec<hn::RebindToUnsigned<Lanes> > low, hn::Vec<hn::RebindToUnsigned<Lanes> > high,
                           ShortMask mask, uint32_t*& end) {
  const ShortLanes d;
  const hn::Half<ShortLanes> half;
  const hn::RebindToUnsigned<Lanes> du;
  const Shorts selected = hn::VecFromMask(d, mask);
  const auto wide = [&](hn::Vec<hn::Half<ShortLanes> > of)
                        HWY_ATTR { return hn::RebindMask(du, hn::Ne(hn::PromoteTo(Lanes(), of), hn::Zero(Lanes()))); };
  end += AppendLanes(du, low, wide(hn::LowerHalf(half, selected)), end);
  end += AppendLanes(du, high, wide(hn::UpperHalf(half, selected)), end);
}

// Appends those of a vector of directions that are not 0, with their entries.
HWY_INLINE void AppendLines(Shorts directions, hn::Vec<hn::RebindToUnsigned<Lanes> > low,
                            hn::Vec<hn::RebindToUnsigned<Lanes> > high, SiftedLines& lines) {
  const hn::Half<ShortLanes> half;
  const hn::RebindToUnsigned<Lanes> du;
  const auto append = [&](hn::Vec<hn::Half<ShortLanes> > of, hn::Vec<decltype(du)> entries) HWY_ATTR {
    const Ints wide = hn::PromoteTo(Lanes(), of);
    const SelectedLanes<decltype(du)> some(du, hn::RebindMask(du, hn::Ne(wide, hn::Zero(Lanes()))));
    some.Store(entries, lines.entries + lines.size);
    some.Store(hn::BitCast(du, wide), lines.directions + lines.size);
    lines.size += some.count();
  };
  append(hn::LowerHalf(half, directions), low);
  append(hn::UpperHalf(half, directions), high);
}

void SiftInLanes(const CornerList& triangles, const LineForms& forms, SiftedLines& lines, std::vector<uint32_t>& kept,
                 uint8_t* is_tiny) {
  const ShortLanes d;
  const hn::RebindToUnsigned<Lanes> du;
  lines.size = 0;
  const size_t before = kept.size();
  kept.resize(before + triangles.size + kSiftLanes);
  uint32_t* kept_end = kept.data() + before;
  uint32_t again[CornerList::kMost + CornerList::kSlack];
  uint32_t* again_end = again;
  for (size_t n = 0; n < triangles.size; n += kSiftLanes) {
    const Values values(forms, Near(LoadCorners(triangles, n), LoadCorners(triangles, n + kTriangleLanes)));
    const ShortMask given = hn::FirstN(d, triangles.size - n);
    const Shorts directions = hn::IfThenElseZero(given, DirectionsOf(forms, values));
    Shorts most = hn::Zero(d);
    for (size_t f = 0; f < forms.between; ++f) most = hn::Max(most, values.integers[f]);
    const ShortMask several = hn::And(hn::And(given, values.tiny), hn::Gt(most, hn::Set(d, 1)));
    const auto low = hn::Iota(du, static_cast<uint32_t>(n)), high = hn::Add(low, hn::Set(du, kTriangleLanes));
    AppendLines(directions, low, high, lines);
    AppendBoth(low, high, several, again_end);
    ShortMask keep = hn::AndNot(values.tiny, given);
    if (is_tiny != nullptr) {
      keep = hn::Or(keep, hn::Or(several, hn::Ne(directions, hn::Zero(d))));
      uint64_t bits = 0;
      hn::StoreMaskBits(d, values.tiny, reinterpret_cast<uint8_t*>(&bits));
      const size_t count = std::min(kSiftLanes, triangles.size - n);
      for (size_t m = 0; m < count; ++m) is_tiny[triangles.triangles[n + m]] = bits >> m & 1;
    }
    if (hn::AllFalse(d, keep)) continue;
    const uint32_t* numbers = triangles.triangles + n;
    AppendBoth(hn::LoadU(du, numbers), hn::LoadU(du, numbers + kTriangleLanes), keep, kept_end);
  }
  kept.resize(static_cast<size_t>(kept_end - kept.data()));

  const auto count = static_cast<size_t>(again_end - again);
  std::fill_n(again_end, kSiftLanes, 0);
  for (size_t n = 0; n < count; n += kSiftLanes) {
    const uint32_t* places = again + n;
    const Values values(forms,
                        Near(LoadCornersAt(triangles, places), LoadCornersAt(triangles, places + kTriangleLanes)));
    const auto append = [&](Shorts lines_of, uint32_t which) HWY_ATTR {
      const auto more = hn::Set(du, which << SiftedLines::kPlaceBits);
      AppendLines(hn::IfThenElseZero(hn::FirstN(d, count - n), lines_of), hn::Add(hn::LoadU(du, places), more),
                  hn::Add(hn::LoadU(du, places + kTriangleLanes), more), lines);
    };
    const Shorts3 directions = MoreDirectionsOf(forms, values);
    for (size_t which = 0; which < 3; ++which) append(directions[which], static_cast<uint32_t>(which) + 1);
  }
  std::fill_n(lines.directions + lines.size, kTriangleLanes, 0);
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

HWY_EXPORT(SiftInLanes);

}  // namespace

void Sift(const CornerList& triangles, const LineForms& forms, SiftedLines& lines, std::vector<uint32_t>& kept,
          uint8_t* is_tiny) {
  if (SimdIsScalar()) return TakeNone(triangles, lines, kept, is_tiny);
  HWY_DYNAMIC_DISPATCH(SiftInLanes)(triangles, forms, lines, kept, is_tiny);
}

}  // namespace latvox
#endif  // HWY_ONCE
