// Triangles in lanes, direction by direction.
//
// Along q a lattice line is a point (a, b) of the projection (core/lattice/frame.h). With the corners (x, y) relative
// to it, the line meets the triangle iff the origin lies inside, that is, iff
//   e[n] = x[n] * y[n+1] - x[n+1] * y[n],   n = 0, 1, 2,
// all have one sign. They are also the barycentric weights of the corners n+2. So the triangle meets the line at depth
// Z = sum(e[n] * z[n+2]) / D, D = sum(e). With U = kLatticeUnit it is nearest to the voxel floor((Z + U/2) / U), for
// which there are few candidates.
//
// Ties (core/digitize/crossing.h). The shift s = (t, t^2, t^3), with infinitesimal t, moves (x, y) by (f.s, g.s), f and
// g being the forms. So it moves e[n] by
//   f.s * (y[n+1] - y[n]) - g.s * (x[n+1] - x[n]) = sum_m s[m] * (f[m] * dy - g[m] * dx).
// The first m with (f[m], g[m]) != 0 decides, unless that term is 0. Then (dx, dy) is parallel to (f[m], g[m]), and the
// next m with an (f[m], g[m]) that is not parallel decides. So two of the entries are enough: the first gets a weight
// that outweighs the second. Ties are rare, and are computed only where there is one.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/tiny/tiny.cc"
#define HWY_WANT_AVX3_DL  // for compressing lanes of 16 bits
#include "core/tiny/tiny.h"

#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <utility>

#include "core/base/append_lanes-inl.h"
#include "core/tiny/line_forms.h"
#include "core/tiny/sift.h"
#include "core/triangles/corner_list-inl.h"

namespace latvox {
#ifndef LATVOX_CORE_DIGITIZE_TINY_CC_ONCE
#define LATVOX_CORE_DIGITIZE_TINY_CC_ONCE
namespace {

// |x|, |y| < 3 * 2^8, and 0 <= z < 4 * 2^8: e is below 2 * (3 * 2^8)^2; D, twice an area, within (3 * 2^8)^2; and
// (Z + U/2) * D below 2^30.
static_assert(kSubvoxelBits <= 8 && kMostIntegers == 2);

// |f[m] * dy - g[m] * dx| <= kMaxFrameRow * 2 * 3 * 2^8.
constexpr int32_t kOutweighs = 1 << 13;
static_assert(kMaxFrameRow * 2 * (kMostIntegers + 1) * kLatticeUnit < kOutweighs);

// A direction in terms of the forms.
struct Direction {
  std::array<size_t, 3> form;
  bool z_is_negated;       // row 2 is the negative of its form
  bool turned;             // (first form, second form) have the other orientation than rows 0 and 1
  int32_t tie_x, tie_y;    // the amounts by which the shift moves x and y, in proportion
  std::array<Vec3i, 2> u;  // columns of U for values of the forms: line (a, b) is a*u[0] + b*u[1] + c*q
  Vec3i q;
  uint32_t packed;  // backward
};

Direction DirectionOf(const Frame& frame, const LineForms& all, size_t n) {
  const auto& [form, sign] = all.of_frame[n];
  const Vec3i &f = all.forms[form[0]], &g = all.forms[form[1]];
  size_t first = 0, second = 0;
  while (f[first] == 0 && g[first] == 0) ++first;
  while (f[first] * g[second] == f[second] * g[first]) ++second;
  return {form,
          sign[2] < 0,
          sign[0] * sign[1] < 0,
          f[first] * kOutweighs + f[second],
          g[first] * kOutweighs + g[second],
          {frame.u[0] * sign[0], frame.u[1] * sign[1]},
          frame.q,
          2 * static_cast<uint32_t>(n)};
}
static_assert(2 * kMaxPairs <= kPackedDirections);

// The facts that all triangles of a mesh share.
struct Scene {
  LineForms all;
  std::vector<Direction> directions;
  IndexBox wanted;  // counted from the first tile's voxel

  Scene(const std::vector<ScanFrame>& frames, const IndexBox& box, const Vec3i& first) : all(frames) {
    for (size_t n = 0; n < frames.size(); ++n) directions.push_back(DirectionOf(frames[n].frame, all, n));
    for (size_t m = 0; m < 3; ++m) {
      wanted.min[m] = std::max(box.min[m] - first[m], 0);
      wanted.max[m] = std::min(box.max[m] - first[m], kTileSide << kPackedTileBits);
    }
  }
};

}  // namespace
#endif
}  // namespace latvox

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET == HWY_SCALAR  // which treats no triangle as tiny
void CrossAll(const Scene&, const CornerList&, const SiftedLines&, uint16_t*, PackedLinks&) {}
#else

namespace hn = hwy::HWY_NAMESPACE;

// Lanes of 16 bits, at least eight. With fewer triangles, the lanes behind them are meaningless.
using ShortLanes = hn::FixedTag<int16_t, std::max<size_t>(kTriangleLanes, 8)>;
using Shorts = hn::Vec<ShortLanes>;
using Shorts3 = std::array<Shorts, 3>;

HWY_INLINE Shorts FillShort(int n) { return hn::Set(ShortLanes(), static_cast<int16_t>(n)); }

HWY_INLINE Ints Widened(Shorts v) {
#if HWY_MAX_BYTES > 16
  return hn::PromoteTo(Lanes(), v);
#else
  return hn::PromoteTo(Lanes(), hn::LowerHalf(hn::Half<ShortLanes>(), v));
#endif
}
HWY_INLINE Ints3 Widened(const Shorts3& v) { return {Widened(v[0]), Widened(v[1]), Widened(v[2])}; }

// A form's values at the corners of a tiny triangle, relative to the integer `from`.
struct FormValues {
  Shorts3 relative;
  Shorts first, from;  // floors of the smallest and the largest value, or less

  HWY_INLINE FormValues(const Vec3i& form, const ShortCorners<ShortLanes>& v, Shorts less)
      : relative(ValuesOf(ShortLanes(), form, v)) {
    first = hn::ShiftRight<kSubvoxelBits>(hn::Min(relative[0], hn::Min(relative[1], relative[2])));
    from = hn::Sub(hn::ShiftRight<kSubvoxelBits>(hn::Max(relative[0], hn::Max(relative[1], relative[2]))), less);
    for (Shorts& value : relative) value = hn::Sub(value, hn::ShiftLeft<kSubvoxelBits>(from));
  }
};

template <class D, class V = hn::Vec<D> >
HWY_INLINE V Times(D d, int32_t c, V v) {
  return c == 0    ? hn::Zero(d)
         : c == 1  ? v
         : c == -1 ? hn::Neg(v)
                   : hn::Mul(hn::Set(d, static_cast<hn::TFromD<D> >(c)), v);
}

// Tests up to kTriangleLanes lines along the direction, each with a tiny triangle that has corners on both sides of it.
//   entries   as in SiftedLines; padded
HWY_INLINE void Cross(const Scene& scene, const Direction& direction, const CornerList& triangles,
                      const uint16_t* entries, size_t count, PackedLinks& out) {
  const Lanes d;
  const hn::RebindToUnsigned<Lanes> du;
  const Ints zero = hn::Zero(d), one = Fill(1);
  const ShortLanes ds;
  Shorts3 voxel;
  const ShortCorners<ShortLanes> v = LoadCornersAt(ds, triangles, entries, voxel);
  const Shorts entry = hn::LoadU(ds, reinterpret_cast<const int16_t*>(entries));
  const Shorts less_a = hn::And(hn::ShiftRight<SiftedLines::kPlaceBits>(entry), FillShort(1));
  const Shorts less_b = hn::ShiftRight<SiftedLines::kPlaceBits + 1>(entry);
  const FormValues first(scene.all.forms[direction.form[0]], v, less_a);
  const FormValues second(scene.all.forms[direction.form[1]], v, less_b);
  const FormValues third(scene.all.forms[direction.form[2]], v, hn::Zero(ds));
  const Ints3 x = Widened(first.relative), y = Widened(second.relative);
  const Ints3 e{Minor(x[0], x[1], y[0], y[1]), Minor(x[1], x[2], y[1], y[2]), Minor(x[2], x[0], y[2], y[0])};
  const Ints3 weight{hn::Abs(e[1]), hn::Abs(e[2]), hn::Abs(e[0])};
  Ints3 side = e;
  const auto given = hn::FirstN(d, count);
  const auto tied = hn::Eq(Least(weight[0], weight[1], weight[2]), zero);
  if (!hn::AllFalse(d, hn::And(given, tied))) {
    const Ints tie_x = Fill(direction.tie_x), tie_y = Fill(direction.tie_y);
    const auto moved = [&](size_t n) HWY_ATTR { return hn::Sub(hn::Mul(tie_x, y[n]), hn::Mul(tie_y, x[n])); };
    const Ints3 by{moved(0), moved(1), moved(2)};
    for (size_t n = 0; n < 3; ++n) side[n] = hn::IfThenElse(hn::Eq(e[n], zero), hn::Sub(by[(n + 1) % 3], by[n]), e[n]);
  }
  const auto negative = hn::Lt(hn::And(hn::And(side[0], side[1]), side[2]), zero);
  const auto positive = hn::Gt(hn::Or3(side[0], side[1], side[2]), Fill(-1));
  auto crossed = hn::And(given, hn::Or(negative, positive));

  // From here on in units of the voxel, `whole`, along the direction: depth * D, D = area.
  const Ints area = hn::Add(hn::Add(weight[0], weight[1]), weight[2]);
  const Ints whole = hn::ShiftLeft<kSubvoxelBits>(area), half = hn::ShiftRight<1>(whole);
  Shorts3 z = third.relative;
  Shorts from;
  if (direction.z_is_negated) {
    from = hn::Not(third.from);  // -from - 1
    for (Shorts& at : z) at = hn::Sub(FillShort(kLatticeUnit), at);
  } else {
    from = third.first;
    const Shorts above = hn::ShiftLeft<kSubvoxelBits>(hn::Sub(third.from, third.first));
    for (Shorts& at : z) at = hn::Add(at, above);
  }
  Ints rest = hn::Add(DotOf(weight, Widened(z)), half);
  constexpr int kMostWhole = kMostIntegers + 1;  // z <= kMostWhole * U
  Ints depth = Widened(hn::Add(from, FillShort(kMostWhole)));
  for (int n = 0; n < kMostWhole; ++n) {
    const Ints less = hn::Sub(rest, whole);  // if negative, it is the larger one as an unsigned number
    rest = hn::BitCast(d, hn::Min(hn::BitCast(du, rest), hn::BitCast(du, less)));
    depth = hn::Add(depth, hn::BroadcastSignBit(less));
  }
  const auto midway = hn::And(crossed, hn::Or(hn::Eq(rest, zero), hn::Eq(rest, half)));
  if (!hn::AllFalse(d, midway)) {
    // The shift moves the plane down along the direction iff its normal, upward along the direction, has a first
    // nonzero entry below 0.
    const Ints3 a = Widened(v[0]), b = Widened(v[1]), c = Widened(v[2]);
    const auto upward = hn::Gt(FirstNonzero(CrossOf(Minus(b, a), Minus(c, a))), zero);
    const auto backward = direction.turned ? hn::Not(negative) : negative;
    const auto down = hn::AndNot(hn::Xor(upward, backward), midway);
    const auto beneath = hn::And(down, hn::Eq(rest, zero));
    rest = hn::Sub(rest, hn::IfThenElseZero(down, one));
    rest = hn::Add(rest, hn::IfThenElseZero(beneath, whole));
    depth = hn::Sub(depth, hn::IfThenElseZero(beneath, one));
  }

  Ints tile = zero, edge = zero;
  for (size_t m = 0; m < 3; ++m) {
    // |from| <= kMaxFrameRow * kNear / U + 1 = 65, and columns of U are minors of rows: within 2^12.
    const Shorts line = hn::Add(Times(ds, direction.u[0][m], first.from), Times(ds, direction.u[1][m], second.from));
    const Ints from_voxel = hn::Add(Widened(line), Times(d, direction.q[m], depth));
    const Ints at = hn::Add(from_voxel, hn::Sub(Widened(voxel[m]), Fill(CornerList::kFirstVoxel)));
    crossed =
        hn::And(crossed, hn::And(hn::Gt(at, Fill(scene.wanted.min[m] - 1)), hn::Lt(at, Fill(scene.wanted.max[m]))));
    tile = hn::Or(hn::ShiftLeft<kPackedTileBits>(tile), hn::ShiftRight<kTileBits>(at));
    edge = hn::Or(hn::ShiftLeft<kTileBits>(edge), hn::And(at, Fill(kTileSide - 1)));
  }
  const Ints forward = hn::IfThenZeroElse(hn::Lt(rest, half), one);
  edge = hn::Or(hn::ShiftLeft<kPackedEndShift>(edge), hn::Or(Fill(direction.packed), forward));
  const SelectedLanes<Lanes> selected(d, crossed);
  selected.Store(tile, out.tiles.end());
  selected.Store(edge, out.links.end());
  out.Grow(selected.count());
}

//   list   memory, of as many entries as `lines`
void CrossAll(const Scene& scene, const CornerList& triangles, const SiftedLines& lines, uint16_t* list,
              PackedLinks& out) {
  const hn::ScalableTag<uint16_t> d;
  for (size_t direction = 0; direction < scene.directions.size(); ++direction) {
    const auto bit = hn::Set(d, static_cast<uint16_t>(1 << direction));
    size_t count = 0;
    for (size_t n = 0; n < lines.size; n += hn::Lanes(d)) {
      const SelectedShorts<decltype(d)> wanted(d, hn::TestBit(hn::LoadU(d, lines.directions + n), bit));
      wanted.Store(hn::LoadU(d, lines.entries + n), list + count);
      count += wanted.count();
    }
    std::fill_n(list + count, hn::MaxLanes(ShortLanes()), 0);
    out.Reserve(count);
    for (size_t n = 0; n < count; n += kTriangleLanes) {
      Cross(scene, scene.directions[direction], triangles, list + n, std::min(kTriangleLanes, count - n), out);
    }
  }
}

#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace latvox {
namespace {

HWY_EXPORT(CrossAll);

}  // namespace

struct TinyCrossings::State {
  Scene scene;
  TileLinks& links;
  std::unique_ptr<TileLinks::Part> part;
  SiftedLines lines = {};
  uint16_t list[SiftedLines::kMost + SiftedLines::kSlack] = {};
  PackedLinks found = {};
};

TinyCrossings::TinyCrossings(const std::vector<ScanFrame>& frames, const IndexBox& box, TileLinks& links)
    : state_(new State{Scene(frames, box, Origin(links)), links, links.ReservePart()}) {}

TinyCrossings::~TinyCrossings() { state_->links.ReleasePart(std::move(state_->part)); }

void TinyCrossings::Find(const CornerList& triangles, std::vector<uint32_t>& kept, uint8_t* is_tiny) {
  auto& [scene, links, part, lines, list, found] = *state_;
  Sift(triangles, scene.all, lines, kept, is_tiny);
  if (lines.size == 0) return;
  HWY_DYNAMIC_DISPATCH(CrossAll)(scene, triangles, lines, list, found);
  part->Move(found, links.margin());
}

}  // namespace latvox
#endif  // HWY_ONCE
