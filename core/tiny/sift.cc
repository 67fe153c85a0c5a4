// Triangles in lanes, all directions one after the other. Few lines lie between corners, and most of these miss the
// triangle.
//
// Along q a lattice line is a point (a, b) of the projection (core/lattice/frame.h). It can only meet a triangle with
// corners on both sides of a, and on both sides of b (core/tiny/touching.h). Let the corners be (x, y) relative to such
// a line. It meets the triangle iff the origin lies inside, that is, iff
//   e[n] = x[n] * y[n+1] - x[n+1] * y[n],   n = 0, 1, 2,
// all have one sign. That need not be decided where e is close to 0, because TinyCrossings decides on all lines that
// pass (core/tiny/tiny.h). So 16 bits of products rounded down are enough: the larger of two products is then not the
// smaller one.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/tiny/sift.cc"
#define HWY_WANT_AVX3_DL  // for compressing lanes of 16 bits
#include "core/tiny/sift.h"

#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <span>

#include "core/base/append_lanes-inl.h"
#include "core/triangles/corner_list-inl.h"

namespace latvox {
#ifndef LATVOX_CORE_DIGITIZE_SIFT_CC_ONCE
#define LATVOX_CORE_DIGITIZE_SIFT_CC_ONCE
namespace {

void KeepAll(const CornerList& triangles, SiftedLines& lines, std::vector<uint32_t>& kept, uint8_t* is_tiny) {
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
  KeepAll(triangles, lines, kept, is_tiny);
}
#else

namespace hn = hwy::HWY_NAMESPACE;

using ShortLanes = hn::ScalableTag<int16_t>;
using Shorts = hn::Vec<ShortLanes>;
using Shorts3 = std::array<Shorts, 3>;
using ShortMask = hn::Mask<ShortLanes>;
constexpr size_t kSiftLanes = 2 * kTriangleLanes;
static_assert(kSiftLanes <= SiftedLines::kSlack && kSiftLanes <= CornerList::kSlack);

// |x|, |y| < (kMostIntegers + 1) * kLatticeUnit get kScaleBits more, and their products lose 16. So products are in
// units of 2^kLostBits, and their differences fit. For a triangle that is not tiny, they are meaningless.
constexpr int kScaleBits = 5, kLostBits = 16 - 2 * kScaleBits;
static_assert((kMostIntegers + 1) * kLatticeUnit << kScaleBits < 1 << 15);

HWY_INLINE Shorts FillShort(int n) { return hn::Set(ShortLanes(), static_cast<int16_t>(n)); }

// The forms' values at the corners of some triangles. A lane's sign says yes or no, because signs are combined in fewer
// steps than masks.
struct Values {
  Shorts3 relative[kMaxForms];  // values of rows 0 and 1, from the last integer that is not above all of them; scaled
  Shorts less[kMaxForms];       // the number of integers between them, negated
  Shorts several;               // whether any such number is above 1
  ShortMask tiny;

  HWY_INLINE Values(const LineForms& forms, const std::array<Shorts3, 3>& v) {
    const ShortLanes d;
    Shorts least = hn::Zero(d);
    several = least;
    for (size_t n = 0; n < forms.forms.size(); ++n) {
      const Shorts3 value = ValuesOf(d, forms.forms[n], v);
      const Shorts first = hn::ShiftRight<kSubvoxelBits>(hn::Min(value[0], hn::Min(value[1], value[2])));
      const Shorts last = hn::ShiftRight<kSubvoxelBits>(hn::Max(value[0], hn::Max(value[1], value[2])));
      less[n] = hn::Sub(first, last);
      least = hn::Min(least, less[n]);
      if (n >= forms.between) continue;
      several = hn::Add(least, FillShort(1));
      const Shorts from = hn::ShiftLeft<kSubvoxelBits>(last);
      for (size_t c = 0; c < 3; ++c) relative[n][c] = hn::ShiftLeft<kScaleBits>(hn::Sub(value[c], from));
    }
    tiny = hn::And(AreNear(d, v), hn::Gt(least, FillShort(-kMostIntegers - 1)));
  }
};

// The two products whose difference is e[n], each rounded down.
struct Edge {
  Shorts plus, minus;
};
using Edges = std::array<Edge, 3>;

HWY_INLINE Edges EdgesOf(const Shorts3& x, const Shorts3& y) {
  const auto edge = [&](size_t from, size_t to) HWY_ATTR {
    return Edge{hn::MulHigh(x[from], y[to]), hn::MulHigh(x[to], y[from])};
  };
  return {edge(0, 1), edge(1, 2), edge(2, 0)};
}

// Whether the origin may be inside. Rounded down, the larger product is not the smaller one.
HWY_INLINE Shorts MayMeet(const Edges& e) {
  const Shorts right =
      hn::Or3(hn::Sub(e[0].plus, e[0].minus), hn::Sub(e[1].plus, e[1].minus), hn::Sub(e[2].plus, e[2].minus));
  const Shorts left =
      hn::Or3(hn::Sub(e[0].minus, e[0].plus), hn::Sub(e[1].minus, e[1].plus), hn::Sub(e[2].minus, e[2].plus));
  return hn::Not(hn::And(left, right));
}

// Sets a direction's bit in lanes with these signs.
HWY_INLINE void SetBit(Shorts bit, Shorts between_a, Shorts between_b, Shorts meets, Shorts& directions) {
  const Shorts all = hn::And(hn::And(between_a, between_b), meets);
  directions = hn::OrAnd(directions, hn::ShiftRight<15>(all), bit);
}

// Bit n: the line (a, b) along direction n, as in SiftedLines, may meet the triangle.
HWY_INLINE Shorts DirectionsOf(const LineForms& forms, const Values& values) {
  Shorts directions = hn::Zero(ShortLanes()), bit = FillShort(1);
  for (const LineForms::OfFrame& frame : forms.of_frame) {
    const size_t a = frame.form[0], b = frame.form[1];
    SetBit(bit, values.less[a], values.less[b], MayMeet(EdgesOf(values.relative[a], values.relative[b])), directions);
    bit = hn::Add(bit, bit);
  }
  return hn::IfThenElseZero(values.tiny, directions);
}

// Does the same for the other lines: (a - 1, b), (a, b - 1), (a - 1, b - 1). From line to line, e[n] gains
//   U * (y[n+1] - y[n])   and   U * (x[n] - x[n+1]).
HWY_INLINE Shorts3 MoreDirectionsOf(const LineForms& forms, const Values& values) {
  const ShortLanes d;
  // Exact: scaled, differences are multiples of 2^kScaleBits.
  const auto step = [&](const Shorts3& v, size_t from, size_t to) HWY_ATTR {
    return hn::ShiftRight<kScaleBits + kLostBits - kSubvoxelBits>(hn::Sub(v[to], v[from]));
  };
  const auto more = [](const Edges& e, const Shorts3& by) HWY_ATTR {
    return Edges{Edge{hn::Add(e[0].plus, by[0]), e[0].minus}, Edge{hn::Add(e[1].plus, by[1]), e[1].minus},
                 Edge{hn::Add(e[2].plus, by[2]), e[2].minus}};
  };
  Shorts3 directions{hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  for (size_t n = 0; n < forms.of_frame.size(); ++n) {
    const size_t a = forms.of_frame[n].form[0], b = forms.of_frame[n].form[1];
    const Shorts any_a = values.less[a], two_a = hn::Add(any_a, FillShort(1));
    const Shorts any_b = values.less[b], two_b = hn::Add(any_b, FillShort(1));
    const Shorts any = hn::And(hn::And(any_a, any_b), hn::Or(two_a, two_b));
    if (hn::AllFalse(d, hn::Lt(any, hn::Zero(d)))) continue;
    const Shorts3 &x = values.relative[a], &y = values.relative[b];
    const Edges e = EdgesOf(x, y);
    const Shorts3 by_a{step(y, 0, 1), step(y, 1, 2), step(y, 2, 0)}, by_b{step(x, 1, 0), step(x, 2, 1), step(x, 0, 2)};
    const Edges less_a = more(e, by_a);
    const Shorts bit = FillShort(1 << n);
    SetBit(bit, two_a, any_b, MayMeet(less_a), directions[0]);
    SetBit(bit, any_a, two_b, MayMeet(more(e, by_b)), directions[1]);
    SetBit(bit, two_a, two_b, MayMeet(more(less_a, by_b)), directions[2]);
  }
  for (Shorts& lines : directions) lines = hn::IfThenElseZero(values.tiny, lines);
  return directions;
}

// Appends the places with a sign set in `which` to a list.
HWY_INLINE void AppendPlaces(Shorts places, Shorts which, uint16_t*& end) {
  const ShortLanes d;
  const SelectedShorts<ShortLanes> some(d, hn::Lt(which, hn::Zero(d)));
  some.Store(places, end);
  end += some.count();
}

// Appends the directions of a vector that are not 0, with their entries.
//   which   x | y << 1, as in SiftedLines
HWY_INLINE void AppendLines(Shorts directions, Shorts places, int which, SiftedLines& lines) {
  const ShortLanes d;
  const SelectedShorts<ShortLanes> some(d, hn::Ne(directions, hn::Zero(d)));
  some.Store(hn::Or(places, FillShort(which << SiftedLines::kPlaceBits)), lines.entries + lines.size);
  some.Store(directions, lines.directions + lines.size);
  lines.size += some.count();
}

void SiftInLanes(const CornerList& triangles, const LineForms& forms, SiftedLines& lines, std::vector<uint32_t>& kept,
                 uint8_t* is_tiny) {
  const ShortLanes d;
  lines.size = 0;
  uint16_t again[CornerList::kMost + CornerList::kSlack];
  uint16_t* again_end = again;
  const Shorts place_of = StoredOrder(d);  // counted from the first one
  const LaneOrder in_order(d, place_of);
  for (size_t n = 0; n < triangles.size; n += kSiftLanes) {
    const Values values(forms, LoadStored(d, triangles, n));
    const ShortMask given = hn::Lt(place_of, FillShort(static_cast<int>(std::min(triangles.size - n, kSiftLanes))));
    const Shorts directions = hn::IfThenElseZero(given, DirectionsOf(forms, values));
    const Shorts several = hn::IfThenElseZero(hn::And(given, values.tiny), values.several);
    const Shorts places = hn::Add(place_of, FillShort(static_cast<int>(n)));
    AppendLines(directions, places, 0, lines);
    AppendPlaces(places, several, again_end);
    const uint32_t* const numbers = triangles.triangles + n;
    ShortMask keep = hn::AndNot(values.tiny, given);
    if (is_tiny != nullptr) {
      keep = hn::Or(keep, hn::Or(hn::Lt(several, hn::Zero(d)), hn::Ne(directions, hn::Zero(d))));
      const uint64_t tiny = in_order(values.tiny);
      const size_t count = std::min(kSiftLanes, triangles.size - n);
      for (size_t m = 0; m < count; ++m) is_tiny[numbers[m]] = tiny >> m & 1;
    }
    if (hn::AllFalse(d, keep)) continue;
    for (uint64_t bits = in_order(keep); bits != 0; bits &= bits - 1) kept.push_back(numbers[std::countr_zero(bits)]);
  }

  const auto count = static_cast<size_t>(again_end - again);
  std::fill_n(again_end, kSiftLanes, 0);
  const Shorts lane = hn::Iota(d, 0);
  for (size_t n = 0; n < count; n += kSiftLanes) {
    Shorts3 voxel;
    const Values values(forms, LoadCornersAt(d, triangles, again + n, voxel));
    const Shorts places = hn::LoadU(d, reinterpret_cast<const int16_t*>(again + n));
    const ShortMask given = hn::Lt(lane, FillShort(static_cast<int>(std::min(count - n, kSiftLanes))));
    const Shorts3 directions = MoreDirectionsOf(forms, values);
    for (int which = 1; which <= 3; ++which) {
      AppendLines(hn::IfThenElseZero(given, directions[static_cast<size_t>(which) - 1]), places, which, lines);
    }
  }
  std::fill_n(lines.directions + lines.size, kSiftLanes, 0);
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
  if (SimdIsScalar()) return KeepAll(triangles, lines, kept, is_tiny);
  HWY_DYNAMIC_DISPATCH(SiftInLanes)(triangles, forms, lines, kept, is_tiny);
}

}  // namespace latvox
#endif  // HWY_ONCE
