// Triangles in the lanes, direction by direction.
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
#include "core/snap/triangle_lanes-inl.h"

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
  bool z_is_negated;       // row 2 is the negative of its form
  bool turned;             // (first form, second form) turn the other way round than rows 0 and 1
  int32_t tie_x, tie_y;    // by which the shift moves x and y, in proportion
  std::array<Vec3i, 2> u;  // columns of U for values of the forms: line (a, b) is a*u[0] + b*u[1] + c*q
  Vec3i q;
  int32_t step;  // from a voxel to its neighbour along q, as numbers
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
          {frame.u[0] * sign[0], frame.u[1] * sign[1]},
          frame.q,
          layout.StepOf(frame.q)};
}

// What all triangles of a box have in common.
struct Scene {
  const SnappedMesh& mesh;
  PaddedVertices vertices;
  LineForms all;
  std::vector<Direction> directions;
  Vec3i size;      // of the box, voxels
  Vec3i origin;    // of the box, lattice units
  int32_t number;  // of its low corner
  Vec3i stride;    // of numbers

  Scene(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames, const IndexBox& box, const BitsLayout& layout)
      : mesh(mesh),
        vertices(mesh),
        all(frames),
        size(box.max - box.min),
        origin(box.min * kLatticeUnit),
        number(static_cast<int32_t>(layout.NumberOf(box.min))),
        stride(layout.stride) {
    for (size_t n = 0; n < frames.size(); ++n) directions.push_back(DirectionOf(frames[n].frame, all, n, layout));
  }
};

// Some tiny triangles, with the lines that they may meet.
constexpr size_t kSome = 1024, kMostLanes = 64;
struct TinyTriangles {
  size_t size = 0;
  uint32_t numbers[kSome + kMostLanes], lines[kSome + kMostLanes];  // whole vectors can be read
};

}  // namespace
#endif
}  // namespace latvox

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET == HWY_SCALAR  // which takes no triangle for tiny
void FindInLanes(const Scene&, const TinyTriangles&, std::vector<NumberList>&, Crossings&) {}
#else

namespace hn = hwy::HWY_NAMESPACE;

// A form's values at the corners of a tiny triangle.
struct FormValues {
  Ints3 relative;    // to the last integer that is not above all
  Ints first, last;  // floors of the least and the largest

  HWY_INLINE FormValues(const Vec3i& form, const std::array<Ints3, 3>& v) : relative(ValuesOf(Lanes(), form, v)) {
    first = hn::ShiftRight<kSubvoxelBits>(Least(relative[0], relative[1], relative[2]));
    last = hn::ShiftRight<kSubvoxelBits>(Most(relative[0], relative[1], relative[2]));
    for (Ints& value : relative) value = hn::Sub(value, hn::ShiftLeft<kSubvoxelBits>(last));
  }
};

// Up to kTriangleLanes tiny triangles, between whose corners a line along the direction lies. The lists have room.
HWY_INLINE void Cross(const Scene& scene, const Direction& direction, std::span<const uint32_t> triangles,
                      uint32_t*& nearer, uint32_t*& farther) {
  const Lanes d;
  const Ints zero = hn::Zero(d);
  const std::array<Ints3, 3> v = LoadCorners(scene.mesh, scene.vertices, LaneNumbers(triangles), scene.origin);
  const auto& [a, b, c] = direction.form;
  const FormValues first(scene.all.forms[a], v), second(scene.all.forms[b], v), third(scene.all.forms[c], v);
  const Ints3 &x = first.relative, &y = second.relative;
  const Ints3 e{Minor(x[0], x[1], y[0], y[1]), Minor(x[1], x[2], y[1], y[2]), Minor(x[2], x[0], y[2], y[0])};
  const Ints tie_x = Fill(direction.tie_x), tie_y = Fill(direction.tie_y);
  const auto moved = [&](size_t n) HWY_ATTR { return hn::Sub(hn::Mul(tie_x, y[n]), hn::Mul(tie_y, x[n])); };
  const Ints3 by{moved(0), moved(1), moved(2)};
  Ints3 side;
  for (size_t n = 0; n < 3; ++n) side[n] = hn::IfThenElse(hn::Eq(e[n], zero), hn::Sub(by[(n + 1) % 3], by[n]), e[n]);
  const Ints least = Least(side[0], side[1], side[2]), most = Most(side[0], side[1], side[2]);
  const auto negative = hn::Lt(most, zero);
  auto crossed = hn::And(hn::FirstN(d, triangles.size()), hn::Or(hn::Gt(least, zero), negative));

  // From here on in units of the voxel, `whole`, along the direction: depth * D, D = area.
  const Ints3 weight{hn::Abs(e[1]), hn::Abs(e[2]), hn::Abs(e[0])};
  const Ints area = hn::Add(hn::Add(weight[0], weight[1]), weight[2]);
  const Ints whole = hn::ShiftLeft<kSubvoxelBits>(area), half = hn::ShiftRight<1>(whole);
  Ints3 z = third.relative;
  Ints from;
  if (direction.z_is_negated) {
    from = hn::Not(third.last);  // -last - 1
    for (Ints& depth : z) depth = hn::Sub(Fill(kLatticeUnit), depth);
  } else {
    from = third.first;
    const Ints less = hn::ShiftLeft<kSubvoxelBits>(hn::Sub(third.last, from));
    for (Ints& depth : z) depth = hn::Add(depth, less);
  }
  // The shift moves the plane down along the direction iff its normal, upward along the direction, has a first nonzero
  // entry below 0.
  const auto upward = hn::Gt(FirstNonzero(CrossOf(Minus(v[1], v[0]), Minus(v[2], v[0]))), zero);
  const auto backward = direction.turned ? hn::Not(negative) : negative;
  const Ints down = hn::IfThenElseZero(hn::Not(hn::Xor(upward, backward)), Fill(1));
  Ints rest = hn::Sub(hn::Add(DotOf(weight, z), half), down);
  for (int n = 0; n < 2; ++n) {
    const auto more = hn::Not(hn::Lt(rest, whole));
    rest = hn::Sub(rest, hn::IfThenElseZero(more, whole));
    from = hn::Add(from, hn::IfThenElseZero(more, Fill(1)));
  }
  Ints number = Fill(scene.number);
  for (size_t m = 0; m < 3; ++m) {
    const Ints at =
        hn::Add(hn::Mul(from, Fill(direction.q[m])),
                hn::Add(hn::Mul(first.last, Fill(direction.u[0][m])), hn::Mul(second.last, Fill(direction.u[1][m]))));
    crossed = hn::And(crossed, hn::And(hn::Gt(at, Fill(-1)), hn::Lt(at, Fill(scene.size[m]))));
    number = hn::Add(number, hn::Mul(at, Fill(scene.stride[m])));
  }
  const Ints step = Fill(direction.step);
  const Ints to_farther = hn::IfThenElse(hn::Lt(rest, half), hn::Neg(step), step);
  const SelectedLanes<Lanes> selected(d, crossed);
  selected.Store(number, nearer);
  selected.Store(hn::Add(number, to_farther), farther);
  nearer += selected.count();
  farther += selected.count();
}

void FindInLanes(const Scene& scene, const TinyTriangles& tiny, std::vector<NumberList>& lists, Crossings& out) {
  const Lanes d;
  const hn::RebindToUnsigned<Lanes> du;
  const std::span<const uint32_t> triangles(tiny.numbers, tiny.size);
  for (NumberList& list : lists) {
    list.Clear();
    list.Reserve(triangles.size());
  }
  for (size_t n = 0; n < triangles.size(); n += kTriangleLanes) {
    PrefetchCorners(scene.mesh, triangles.subspan(n));
    const auto given = hn::FirstN(du, triangles.size() - n);
    const auto numbers = hn::LoadU(du, tiny.numbers + n);
    const auto lines = hn::IfThenElseZero(given, hn::LoadU(du, tiny.lines + n));
    for (size_t direction = 0; direction < lists.size(); ++direction) {
      const auto may_meet = hn::TestBit(lines, hn::Set(du, 1U << direction));
      lists[direction].Grow(AppendLanes(du, numbers, may_meet, lists[direction].end()));
    }
  }
  for (size_t direction = 0; direction < lists.size(); ++direction) {
    const std::span<const uint32_t> list = lists[direction].view();
    out.nearer.Reserve(list.size());
    out.farther.Reserve(list.size());
    uint32_t *nearer = out.nearer.end(), *farther = out.farther.end();
    for (size_t n = 0; n < list.size(); n += kTriangleLanes) {
      Cross(scene, scene.directions[direction], list.subspan(n, std::min(kTriangleLanes, list.size() - n)), nearer,
            farther);
    }
    out.nearer.Grow(static_cast<size_t>(nearer - out.nearer.end()));
    out.farther.Grow(static_cast<size_t>(farther - out.farther.end()));
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

HWY_EXPORT(FindInLanes);

}  // namespace

void FindTinyCrossings(const SnappedMesh& mesh, std::span<const uint32_t> triangles, std::span<const MetLines> met,
                       const std::vector<ScanFrame>& frames, const IndexBox& box, const BitsLayout& layout,
                       const std::atomic<bool>& cancelled, Crossings& crossings, std::vector<uint32_t>& others) {
  const Scene scene(mesh, frames, box, layout);
  std::vector<NumberList> lists(frames.size());  // by direction, tiny triangles that a line may meet
  TinyTriangles tiny;
  for (size_t n = 0; n < triangles.size() && !cancelled; n += kSome) {
    const auto some = triangles.subspan(n, std::min(kSome, triangles.size() - n));
    others.resize(others.size() + some.size());
    uint32_t* other = others.data() + others.size() - some.size();
    tiny.size = 0;
    for (const uint32_t t : some) {  // which of the two is hard to predict
      const bool is_tiny = met[t] != kNotTiny;
      tiny.numbers[tiny.size] = *other = t;
      tiny.lines[tiny.size] = met[t];
      tiny.size += is_tiny ? 1 : 0;
      other += is_tiny ? 0 : 1;
    }
    others.resize(static_cast<size_t>(other - others.data()));
    HWY_DYNAMIC_DISPATCH(FindInLanes)(scene, tiny, lists, crossings);
  }
}

}  // namespace latvox
#endif  // HWY_ONCE
