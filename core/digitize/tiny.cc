// Triangles in the lanes, direction after direction.
//
// Along q a lattice line is a point (a, b) of the projection (core/lattice/frame.h). Let a be the one integer between
// the values of the first form at the corners, b that of the second: relative to it, the corners are (x, y) with
// |x|, |y| <= U = kLatticeUnit. The line meets the triangle iff the origin lies inside, which is to say that
//   e[n] = x[n] * y[n+1] - x[n+1] * y[n],   n = 0, 1, 2,
// all have one sign. They are the barycentric weights of the corners n+2, too: so the triangle meets the line at depth
// Z = sum(e[n] * z[n+2]) / D, D = sum(e). It is nearest to the voxel floor((Z + U/2) / U), which has few candidates.
//
// Ties (core/digitize/crossing.h). The shift s = (t, t^2, t^3), infinitesimal t, moves (x, y) by (f.s, g.s), f and g
// the forms, hence e[n] by
//   f.s * (y[n+1] - y[n]) - g.s * (x[n+1] - x[n]) = sum_m s[m] * (f[m] * dy - g[m] * dx).
// If that is 0 for the first m with (f[m], g[m]) != 0, (dx, dy) is parallel to these, and the next m for which (f[m],
// g[m]) is not decides. So two of the entries do: the first is given a weight that outweighs the second.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/digitize/tiny.cc"
#include "core/digitize/tiny.h"

#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "core/base/append_lanes-inl.h"
#include "core/digitize/line_forms.h"
#include "core/digitize/triangle_lanes-inl.h"

namespace latvox {
#ifndef LATVOX_CORE_DIGITIZE_TINY_CC_ONCE
#define LATVOX_CORE_DIGITIZE_TINY_CC_ONCE
namespace {

// |x|, |y| <= 2^8, |z| <= 2^9: e has 17 bits, D is twice an area within (2^9)^2, and Z * D + U/2 * D has 28.
static_assert(kSubvoxelBits <= 8);

// |f[m] * dy - g[m] * dx| <= kMaxFrameRow * 2 * 2^9.
constexpr int32_t kOutweighs = 1 << 13;
static_assert(kMaxFrameRow * 2 * 2 * kLatticeUnit < kOutweighs);

// What a direction makes of forms.
struct Direction {
  std::array<size_t, 3> form;
  bool z_is_negated;             // row 2 is the negative of its form
  bool turned;                   // (first form, second form) turn the other way round than rows 0 and 1
  int32_t tie_x, tie_y;          // by which the shift moves x and y, in proportion
  int32_t step_a, step_b, step;  // from a voxel to its neighbours along a form, and along the direction, as numbers
};

Direction DirectionOf(const Frame& frame, const LineForms& all, size_t n, const BitsLayout& layout) {
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
          layout.StepOf(frame.u[0]) * sign[0],
          layout.StepOf(frame.u[1]) * sign[1],
          layout.StepOf(frame.q)};
}

// What all triangles of a box have in common.
struct Scene {
  const SnappedMesh& mesh;
  PaddedVertices vertices;
  LineForms all;
  std::vector<Direction> directions;
  Vec3i size;      // of the box, voxels
  Vec3i reach;     // per axis, the largest |q|
  Vec3i origin;    // of the box, lattice units
  int32_t number;  // of its low corner

  Scene(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames, const IndexBox& box, const BitsLayout& layout)
      : mesh(mesh),
        vertices(mesh),
        all(frames),
        size(box.max - box.min),
        reach{},
        origin(box.min * kLatticeUnit),
        number(static_cast<int32_t>(layout.NumberOf(box.min))) {
    for (size_t n = 0; n < frames.size(); ++n) {
      directions.push_back(DirectionOf(frames[n].frame, all, n, layout));
      for (size_t m = 0; m < 3; ++m) reach[m] = std::max(reach[m], std::abs(frames[n].frame.q[m]));
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

#if HWY_TARGET == HWY_SCALAR
void FindInLanes(const Scene&, std::span<const uint32_t> triangles, Crossings&, std::vector<uint32_t>& others) {
  others.insert(others.end(), triangles.begin(), triangles.end());
}
#else

namespace hn = hwy::HWY_NAMESPACE;

// A form's values at the corners, relative to the last integer that is not above all of them.
struct FormValues {
  Ints3 relative;
  Ints first, last;  // floors of the least and the largest value
};

// The triangles' values of each form; returns a bit for each form between whose values an integer lies. Leaves those
// tiny that have no more than one integer between values.
HWY_INLINE Ints Evaluate(const LineForms& all, const std::array<Ints3, 3>& v, FormValues* values,
                         hn::Mask<Lanes>& tiny) {
  Ints between = hn::Zero(Lanes());
  for (size_t n = 0; n < all.forms.size(); ++n) {
    const Ints3 form = Fill3(all.forms[n]);
    const Ints3 value{DotOf(form, v[0]), DotOf(form, v[1]), DotOf(form, v[2])};
    FormValues& out = values[n];
    out.first = hn::ShiftRight<kSubvoxelBits>(Least(value[0], value[1], value[2]));
    out.last = hn::ShiftRight<kSubvoxelBits>(Most(value[0], value[1], value[2]));
    const Ints from = hn::ShiftLeft<kSubvoxelBits>(out.last);
    for (size_t c = 0; c < 3; ++c) out.relative[c] = hn::Sub(value[c], from);
    const Ints integers = hn::Sub(out.last, out.first);
    tiny = hn::And(tiny, hn::Lt(integers, Fill(2)));
    if (n < all.between) between = hn::Or(between, hn::ShiftLeftSame(integers, static_cast<int>(n)));
  }
  return between;
}

// Up to kTriangleLanes triangles. The lists have room.
HWY_INLINE void CrossSome(const Scene& scene, std::span<const uint32_t> triangles, uint32_t*& nearer,
                          uint32_t*& farther, uint32_t*& others) {
  const Lanes d;
  const Ints zero = hn::Zero(d);
  const std::array<Ints3, 3> v = LoadCorners(scene.mesh, scene.vertices, triangles, scene.origin);
  const auto given = hn::FirstN(d, triangles.size());
  auto tiny = given;
  for (size_t m = 0; m < 3; ++m) {
    const Ints low = Least(v[0][m], v[1][m], v[2][m]), high = Most(v[0][m], v[1][m], v[2][m]);
    const int32_t half_step = scene.reach[m] * kLatticeUnit / 2;
    tiny = hn::And(tiny, hn::Gt(low, Fill(half_step - kLatticeUnit)));
    tiny = hn::And(tiny, hn::Lt(high, Fill(scene.size[m] * kLatticeUnit - half_step)));
  }
  FormValues values[kMaxForms];
  const Ints between = Evaluate(scene.all, v, values, tiny);
  if (hn::CountTrue(d, tiny) < kTriangleLanes / 4) tiny = hn::FirstN(d, 0);  // not worth going through all directions
  const auto upward = hn::Gt(FirstNonzero(CrossOf(Minus(v[1], v[0]), Minus(v[2], v[0]))), zero);

  for (const Direction& direction : scene.directions) {
    const auto& [a, b, c] = direction.form;
    const Ints both = Fill(1 << a | 1 << b);
    const auto candidate = hn::And(tiny, hn::Eq(hn::And(between, both), both));
    if (hn::AllFalse(d, candidate)) continue;
    const Ints3 &x = values[a].relative, &y = values[b].relative;
    const Ints3 e{Minor(x[0], x[1], y[0], y[1]), Minor(x[1], x[2], y[1], y[2]), Minor(x[2], x[0], y[2], y[0])};
    Ints least = Least(e[0], e[1], e[2]), most = Most(e[0], e[1], e[2]);
    auto crossed = hn::AndNot(hn::And(hn::Lt(least, zero), hn::Gt(most, zero)), candidate);
    if (hn::AllFalse(d, crossed)) continue;
    if (!hn::AllFalse(d, hn::And(crossed, hn::Or(hn::Eq(least, zero), hn::Eq(most, zero))))) {
      const Ints tie_x = Fill(direction.tie_x), tie_y = Fill(direction.tie_y);
      const auto moved = [&](size_t n) HWY_ATTR { return hn::Sub(hn::Mul(tie_x, y[n]), hn::Mul(tie_y, x[n])); };
      const Ints3 by{moved(0), moved(1), moved(2)};
      Ints3 side;
      for (size_t n = 0; n < 3; ++n)
        side[n] = hn::IfThenElse(hn::Eq(e[n], zero), hn::Sub(by[(n + 1) % 3], by[n]), e[n]);
      least = Least(side[0], side[1], side[2]);
      most = Most(side[0], side[1], side[2]);
      crossed = hn::And(candidate, hn::Or(hn::Gt(least, zero), hn::Lt(most, zero)));
      if (hn::AllFalse(d, crossed)) continue;
    }
    const auto negative = hn::Lt(most, zero);

    // From here on in units of the voxel, `whole`, along the direction: depth * D, D = area.
    const Ints3 weight{hn::Abs(e[1]), hn::Abs(e[2]), hn::Abs(e[0])};
    const Ints area = hn::Add(hn::Add(weight[0], weight[1]), weight[2]);
    const Ints whole = hn::ShiftLeft<kSubvoxelBits>(area), half = hn::ShiftRight<1>(whole);
    Ints3 z = values[c].relative;
    Ints from;
    if (direction.z_is_negated) {
      from = hn::Not(values[c].last);  // -last - 1
      for (Ints& depth : z) depth = hn::Sub(Fill(kLatticeUnit), depth);
    } else {
      from = values[c].first;
      const Ints less = hn::ShiftLeft<kSubvoxelBits>(hn::Sub(values[c].last, from));
      for (Ints& depth : z) depth = hn::Add(depth, less);
    }
    // The shift moves the plane down along the direction iff its normal, upward along the direction, has a first
    // nonzero entry below 0.
    const auto backward = direction.turned ? hn::Not(negative) : negative;
    const Ints down = hn::IfThenElseZero(hn::Not(hn::Xor(upward, backward)), Fill(1));
    Ints rest = hn::Sub(hn::Add(DotOf(weight, z), half), down);
    for (int n = 0; n < 2; ++n) {
      const auto more = hn::Not(hn::Lt(rest, whole));
      rest = hn::Sub(rest, hn::IfThenElseZero(more, whole));
      from = hn::Add(from, hn::IfThenElseZero(more, Fill(1)));
    }
    const Ints step = Fill(direction.step);
    Ints number = hn::Add(Fill(scene.number), hn::Mul(from, step));
    number = hn::Add(number, hn::Mul(values[a].last, Fill(direction.step_a)));
    number = hn::Add(number, hn::Mul(values[b].last, Fill(direction.step_b)));
    const Ints to_farther = hn::IfThenElse(hn::Lt(rest, half), hn::Neg(step), step);
    const SelectedLanes<Lanes> selected(d, crossed);
    selected.Store(number, nearer);
    selected.Store(hn::Add(number, to_farther), farther);
    nearer += selected.count();
    farther += selected.count();
  }
  const hn::RebindToUnsigned<Lanes> du;
  alignas(64) uint32_t numbers[kTriangleLanes] = {};
  std::copy(triangles.begin(), triangles.end(), numbers);
  others += AppendLanes(du, hn::Load(du, numbers), hn::RebindMask(du, hn::AndNot(tiny, given)), others);
}

void FindInLanes(const Scene& scene, std::span<const uint32_t> triangles, Crossings& out,
                 std::vector<uint32_t>& others) {
  const size_t before = others.size(), most = triangles.size() * scene.directions.size();
  others.resize(before + triangles.size() + kTriangleLanes);
  out.nearer.Reserve(most);
  out.farther.Reserve(most);
  uint32_t *nearer = out.nearer.end(), *farther = out.farther.end(), *other = others.data() + before;
  for (size_t n = 0; n < triangles.size(); n += kTriangleLanes) {
    PrefetchCorners(scene.mesh, triangles.subspan(n));
    CrossSome(scene, triangles.subspan(n, std::min(kTriangleLanes, triangles.size() - n)), nearer, farther, other);
  }
  out.nearer.Grow(static_cast<size_t>(nearer - out.nearer.end()));
  out.farther.Grow(static_cast<size_t>(farther - out.farther.end()));
  others.resize(static_cast<size_t>(other - others.data()));
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

HWY_EXPORT(FindInLanes);

}  // namespace

void FindTinyCrossings(const SnappedMesh& mesh, std::span<const uint32_t> triangles,
                       const std::vector<ScanFrame>& frames, const IndexBox& box, const BitsLayout& layout,
                       const std::atomic<bool>& cancelled, Crossings& crossings, std::vector<uint32_t>& others) {
  if (SimdIsScalar()) {
    others.insert(others.end(), triangles.begin(), triangles.end());
    return;
  }
  constexpr size_t kSome = 1024;
  const Scene scene(mesh, frames, box, layout);
  for (size_t n = 0; n < triangles.size() && !cancelled; n += kSome) {
    HWY_DYNAMIC_DISPATCH(FindInLanes)
    (scene, triangles.subspan(n, std::min(kSome, triangles.size() - n)), crossings, others);
  }
}

}  // namespace latvox
#endif  // HWY_ONCE
