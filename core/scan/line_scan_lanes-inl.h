// MakeLineScan (core/scan/line_scan.h) for many triangles, one for each lane. It gives the same results in 32 bits.
#if defined(LATVOX_CORE_SCAN_LINE_SCAN_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LATVOX_CORE_SCAN_LINE_SCAN_LANES_INL_H_
#undef LATVOX_CORE_SCAN_LINE_SCAN_LANES_INL_H_
#else
#define LATVOX_CORE_SCAN_LINE_SCAN_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <type_traits>

#include "core/scan/cover_bounds-inl.h"
#include "core/scan/line_scan.h"
#include "core/triangles/triangle_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

// An integer for each lane, in memory.
struct alignas(64) LaneInts {
  int32_t of[kTriangleLanes];
  HWY_INLINE void operator=(Ints v) { hn::Store(v, Lanes(), of); }
  HWY_INLINE Ints Load() const { return hn::Load(Lanes(), of); }
};

// LineScan<int32_t> of each lane, and the number of its frame. PrepareBlocks sets the shapes, the steps of blocks and
// `astride`. If no lane is valid, only `valid` is set.
struct LineScanLanes {
  LaneInts a, b, width, height, edge[3], edge_a[3], edge_b[3], rim[3], along, level_a, level_b, remainder, half, depth,
      shape, right_depth, right_remainder, down_depth, down_remainder, frame;
  LaneInts second, sure_second, enough_above[3], enough_below[3];  // of a supercover, see SecondVoxels
  uint64_t valid;                                                  // bit n: lane n may have a candidate in the box
  uint64_t astride[3];  // bit n: some of its lines may have their voxel beyond the box's bounds on this axis

  LineScan<int32_t> At(size_t n) const {
    LineScan<int32_t> s;
    s.a = a.of[n];
    s.b = b.of[n];
    s.width = width.of[n];
    s.height = height.of[n];
    for (size_t m = 0; m < 3; ++m) {
      s.edge[m] = edge[m].of[n];
      s.edge_a[m] = edge_a[m].of[n];
      s.edge_b[m] = edge_b[m].of[n];
      s.rim[m] = rim[m].of[n];
    }
    s.along = along.of[n];
    s.level_a = level_a.of[n];
    s.level_b = level_b.of[n];
    s.remainder = remainder.of[n];
    s.half = half.of[n];
    s.doubt = 0;
    s.depth = depth.of[n];
    s.shape = shape.of[n];
    s.right_depth = right_depth.of[n];
    s.right_remainder = right_remainder.of[n];
    s.down_depth = down_depth.of[n];
    s.down_remainder = down_remainder.of[n];
    return s;
  }
};

// Blocks of lines are vectors: one row as long as a vector, two rows half as long, or four rows a quarter as long.
inline constexpr int32_t kShapes = 3;
template <class T>
constexpr int32_t BlockWidth(int32_t shape) {
  return std::max(static_cast<int32_t>(HWY_LANES(T)) >> shape, 1);
}

// Adds a * b, which may not fit, to kLatticeUnit * whole + rest.
HWY_INLINE void AddProduct(Ints a, Ints b, Ints& whole, Ints& rest) {
  const Ints low_bits = Fill(kLatticeUnit - 1), part = hn::And(b, low_bits);
  whole = hn::Add(whole, hn::Mul(a, hn::ShiftRight<kSubvoxelBits>(b)));
  whole = hn::Add(whole, hn::Mul(hn::ShiftRight<kSubvoxelBits>(a), part));
  rest = hn::Add(rest, hn::Mul(hn::And(a, low_bits), part));
}

// Floor division of small sums: n = quotient * d + remainder, from an estimate that is wrong by at most one.
template <class D, class V, class F>
HWY_INLINE void Divide(D d, V n, F estimate, V divisor, V& quotient, V& remainder) {
  const V one = hn::Set(d, 1);
  V q = hn::ConvertTo(d, hn::Floor(estimate));  // rounding towards zero could add another error of one
  V r = hn::Sub(n, hn::Mul(q, divisor));
  const auto below = hn::Lt(r, hn::Zero(d));
  r = hn::IfThenElse(below, hn::Add(r, divisor), r);
  q = hn::IfThenElse(below, hn::Sub(q, one), q);
  const auto above = hn::Gt(r, hn::Sub(divisor, one));
  remainder = hn::IfThenElse(above, hn::Sub(r, divisor), r);
  quotient = hn::IfThenElse(above, hn::Add(q, one), q);
}

// Reads the entries of a FrameTable's row for the frames of the lanes.
class FramePick {
 public:
  explicit FramePick(Ints frame) : frame_(frame) {}
  HWY_INLINE Ints operator()(const FrameTable::Row& row) const {
    if constexpr (kTriangleLanes == kMaxDirections) {
      return hn::TableLookupLanes(hn::Load(Lanes(), row.of), hn::IndicesFromVec(Lanes(), frame_));
    } else if constexpr (2 * kTriangleLanes == kMaxDirections) {
      const Lanes d;
      const auto index = hn::IndicesFromVec(d, hn::And(frame_, Fill(kTriangleLanes - 1)));
      const Ints low = hn::TableLookupLanes(hn::Load(d, row.of), index);
      const Ints high = hn::TableLookupLanes(hn::Load(d, row.of + kTriangleLanes), index);
      return hn::IfThenElse(hn::Gt(frame_, Fill(kTriangleLanes - 1)), high, low);
    } else {
      return hn::GatherIndex(Lanes(), row.of, frame_);
    }
  }
  HWY_INLINE Ints3 operator()(const std::array<FrameTable::Row, 3>& rows) const {
    return {(*this)(rows[0]), (*this)(rows[1]), (*this)(rows[2])};
  }

 private:
  Ints frame_;
};

// Like BoundsWithin (core/scan/line_scan.cc): narrows the bounds of the forms p[0] and p[1] to the part of the triangle
// between the two planes of `near` on each axis. Precondition: there is such a part on each axis.
HWY_INLINE void CutBounds(const NearBox& near, const std::array<Ints3, 3>& v, const std::array<Ints3, 2>& p,
                          std::array<Ints, 2>& first, std::array<Ints, 2>& last) {
  const Lanes d;
  const hn::RebindToFloat<Lanes> df;
  using Floats = hn::Vec<decltype(df)>;
  const auto to_float = [&](Ints i) HWY_ATTR { return hn::ConvertTo(df, i); };
  std::array<std::array<Floats, 3>, 2> at, over;  // the forms at corner n, and their change to the next corner
  for (size_t c = 0; c < 2; ++c) {
    for (size_t n = 0; n < 3; ++n) at[c][n] = to_float(p[c][n]);
    for (size_t n = 0; n < 3; ++n) over[c][n] = hn::Sub(at[c][(n + 1) % 3], at[c][n]);
  }
  for (size_t m = 0; m < 3; ++m) {
    const auto far = hn::Set(df, static_cast<float>(1 << 30));
    std::array<Floats, 2> least{far, far}, most{hn::Neg(far), hn::Neg(far)};
    // The point at the fraction t of the way from corner n to the next.
    const auto add = [&](auto where, size_t n, Floats t) HWY_ATTR {
      for (size_t c = 0; c < 2; ++c) {
        const Floats value = hn::MulAdd(t, over[c][n], at[c][n]);
        least[c] = hn::IfThenElse(where, hn::Min(least[c], value), least[c]);
        most[c] = hn::IfThenElse(where, hn::Max(most[c], value), most[c]);
      }
    };
    const auto low = hn::Set(df, static_cast<float>(near.min[m])), high = hn::Set(df, static_cast<float>(near.max[m]));
    const Floats z[3] = {to_float(v[0][m]), to_float(v[1][m]), to_float(v[2][m])};
    for (size_t n = 0; n < 3; ++n) {
      const Floats next = z[(n + 1) % 3], per = hn::Div(hn::Set(df, 1.0F), hn::Sub(next, z[n]));
      add(hn::And(hn::Ge(z[n], low), hn::Le(z[n], high)), n, hn::Zero(df));
      for (const Floats plane : {low, high}) {
        add(hn::Xor(hn::Lt(z[n], plane), hn::Lt(next, plane)), n, hn::Mul(hn::Sub(plane, z[n]), per));
      }
    }
    for (size_t c = 0; c < 2; ++c) {
      first[c] = hn::Max(first[c], hn::Sub(hn::ConvertTo(d, hn::Floor(least[c])), Fill(1)));
      last[c] = hn::Min(last[c], hn::Add(hn::ConvertTo(d, hn::Ceil(most[c])), Fill(1)));
    }
  }
}

// Narrowing bounds costs about as much as it saves at this number of lines of triangles that reach beyond the box.
inline constexpr int32_t kLinesToCut = 2048;

// The lines of each lane's triangle along its principal direction: a box of lines.
struct LineBoxes {
  std::array<Ints3, 3> v;    // corners, counter-clockwise in the projection
  Ints3 normal;              // along the direction
  Ints along, frame;         // normal . q, number
  Ints3 x, y;                // of the projection
  Ints a, b, width, height;  // as in LineScan
  uint64_t valid;            // lanes with lines

  // corners   by axis, in lattice units from the low corner of the box that candidates must lie in
  // wanted    the lanes with a triangle
  // Precondition: extents are at most NarrowExtent, and the triangles are near the box.
  HWY_INLINE LineBoxes(const FrameTable& frames, const std::array<Ints3, 3>& corners, hn::Mask<Lanes> wanted)
      : v(corners) {
    const Lanes d;
    const Ints zero = hn::Zero(d), one = Fill(1);

    // The principal direction: the frame with the largest |normal . q|.
    normal = CrossOf(Minus(v[1], v[0]), Minus(v[2], v[0]));
    Ints up = zero;
    along = zero, frame = zero;
    const Multiples<Lanes> multiples(d, normal, frames.reach);
    for (size_t n = 0; n < frames.size; ++n) {
      const Ints dot = multiples.Dot({frames.q[0].of[n], frames.q[1].of[n], frames.q[2].of[n]});
      const auto more = hn::Gt(hn::Abs(dot), along);
      up = hn::IfThenElse(more, dot, up);
      frame = hn::IfThenElse(more, Fill(static_cast<int64_t>(n)), frame);
      along = hn::Max(along, hn::Abs(dot));
    }

    TurnWhere(hn::Lt(up, zero));

    const FramePick pick(frame);
    const Ints3 r0 = pick(frames.r[0]), r1 = pick(frames.r[1]);
    x = {DotOf(r0, v[0]), DotOf(r0, v[1]), DotOf(r0, v[2])};
    y = {DotOf(r1, v[0]), DotOf(r1, v[1]), DotOf(r1, v[2])};
    std::array<Ints, 2> low{Least(x[0], x[1], x[2]), Least(y[0], y[1], y[2])};
    std::array<Ints, 2> high{Most(x[0], x[1], x[2]), Most(y[0], y[1], y[2])};
    // For triangles that reach beyond the box, only the lines of the part within.
    const auto lines = [&](hn::Mask<Lanes> of) HWY_ATTR {
      const Ints many = hn::Mul(hn::ShiftRight<kSubvoxelBits>(hn::Sub(high[0], low[0])),
                                hn::ShiftRight<kSubvoxelBits>(hn::Sub(high[1], low[1])));
      return hn::GetLane(hn::SumOfLanes(d, hn::IfThenElseZero(of, many)));
    };
    if (lines(wanted) > kLinesToCut) {
      auto within = wanted;
      for (size_t m = 0; m < 3; ++m) {
        within = hn::And(within, hn::Gt(Least(v[0][m], v[1][m], v[2][m]), Fill(frames.near.min[m] - 1)));
        within = hn::And(within, hn::Lt(Most(v[0][m], v[1][m], v[2][m]), Fill(frames.near.max[m] + 1)));
      }
      if (lines(hn::AndNot(within, wanted)) > kLinesToCut) CutBounds(frames.near, v, {x, y}, low, high);
    }
    const auto first = [&](size_t axis) HWY_ATTR {
      const Ints from = hn::Sub(low[axis], pick(frames.rim[axis]));
      return hn::Max(hn::ShiftRight<kSubvoxelBits>(hn::Add(from, Fill(kLatticeUnit - 1))), pick(frames.first[axis]));
    };
    const auto count = [&](size_t axis, Ints from) HWY_ATTR {
      const Ints to = hn::Add(high[axis], pick(frames.rim[axis]));
      const Ints last = hn::Min(hn::ShiftRight<kSubvoxelBits>(to), pick(frames.last[axis]));
      return hn::Add(hn::Sub(last, from), one);
    };
    a = first(0), b = first(1);
    width = count(0, a), height = count(1, b);
    wanted = hn::And(wanted, hn::And(hn::Gt(along, zero), hn::Gt(hn::Min(width, height), zero)));
    valid = BitsOf(wanted);
  }

 private:
  // Where corners are clockwise in the projection, reverses them. Then the normal points along q.
  HWY_INLINE void TurnWhere(hn::Mask<Lanes> backward) {
    for (size_t m = 0; m < 3; ++m) {
      normal[m] = hn::IfThenElse(backward, hn::Neg(normal[m]), normal[m]);
      const Ints second = v[1][m];
      v[1][m] = hn::IfThenElse(backward, v[2][m], second);
      v[2][m] = hn::IfThenElse(backward, second, v[2][m]);
    }
  }
};

// The depths of voxels on lines, seen from the box's line (a, b).
HWY_INLINE void MakeDepths(const FrameTable& frames, const FramePick& pick, const LineBoxes& boxes,
                           LineScanLanes& out) {
  const Lanes d;
  const hn::RebindToFloat<Lanes> df;
  const Ints zero = hn::Zero(d), one = Fill(1);
  const auto& [v, normal, along, frame, x, y, a, b, width, height, valid] = boxes;
  const Ints3 u0 = pick(frames.u[0]), u1 = pick(frames.u[1]);
  const Ints from_a = hn::ShiftLeft<kSubvoxelBits>(a), from_b = hn::ShiftLeft<kSubvoxelBits>(b);
  const Ints flip = hn::IfThenElseZero(hn::Lt(FirstNonzero(normal), zero), one);
  const Ints n_a = DotOf(normal, u0), n_b = DotOf(normal, u1);
  const Ints z0 = hn::Add(DotOf(pick(frames.r[2]), v[0]), Fill(kLatticeUnit / 2));
  const Ints to_x = hn::Sub(x[0], from_a), to_y = hn::Sub(y[0], from_b);
  Ints level = zero, rest = hn::Neg(flip);
  AddProduct(along, z0, level, rest);
  AddProduct(n_a, to_x, level, rest);
  AddProduct(n_b, to_y, level, rest);
  level = hn::Add(level, hn::ShiftRight<kSubvoxelBits>(rest));  // modulo 2^32, which holds the remainder
  const auto to_float = [&](Ints i) HWY_ATTR { return hn::ConvertTo(df, i); };
  const auto slopes = hn::Add(hn::Mul(to_float(n_a), to_float(to_x)), hn::Mul(to_float(n_b), to_float(to_y)));
  const auto estimate =
      hn::Mul(hn::Add(to_float(z0), hn::Div(slopes, to_float(along))), hn::Set(df, 1.0F / kLatticeUnit));
  Ints depth, remainder;
  Divide(d, level, estimate, along, depth, remainder);
  const auto low_part = hn::Lt(hn::And(rest, Fill(kLatticeUnit - 1)), Fill(kLatticeUnit / 2));
  out.along = along;
  out.level_a = hn::Neg(n_a);
  out.level_b = hn::Neg(n_b);
  out.depth = depth;
  out.remainder = remainder;
  out.half = hn::ShiftRight<1>(hn::Add(along, hn::IfThenElseZero(low_part, one)));
}

// Leaves the members of PrepareBlocks open.
//   seconds   for the scan of a supercover; else null
template <class Seconds>
HWY_INLINE void MakeLineScans(const FrameTable& frames, const LineBoxes& boxes, Seconds seconds, LineScanLanes& out) {
  constexpr bool kCover = !std::is_null_pointer_v<Seconds>;
  const Lanes d;
  const Ints zero = hn::Zero(d), one = Fill(1);
  const auto& [v, normal, along, frame, x, y, a, b, width, height, valid] = boxes;
  out.valid = valid;
  if (valid == 0) return;
  out.frame = frame;
  out.a = a;
  out.b = b;
  out.width = width;
  out.height = height;

  const FramePick pick(frame);
  const Ints3 q = pick(frames.q);
  std::array<std::array<Ints, 2>, kMaxHull> hull;
  if constexpr (kCover) {
    out.second = seconds->maybe();
    out.sure_second = seconds->sure();
  }
  for (size_t h = 0; h < frames.hull_size; ++h) hull[h] = {pick(frames.hull[h][0]), pick(frames.hull[h][1])};
  const Ints from_a = hn::ShiftLeft<kSubvoxelBits>(a), from_b = hn::ShiftLeft<kSubvoxelBits>(b);
  for (size_t n = 0; n < 3; ++n) {
    const size_t next = (n + 1) % 3;
    const Ints dx = hn::Sub(x[next], x[n]), dy = hn::Sub(y[next], y[n]);
    Ints rim = zero, at_corner = zero;
    for (size_t h = 0; h < frames.hull_size; ++h) {
      const Ints over = Minor(dx, dy, hull[h][0], hull[h][1]), size = hn::Abs(over);
      rim = kCover ? hn::Add(rim, size) : hn::Max(rim, size);
      if constexpr (kCover) at_corner = seconds->AddStep(at_corner, h, over);
    }
    if constexpr (kCover) {
      const auto [above, below] = seconds->EnoughOf(at_corner);
      out.enough_above[n] = above;
      out.enough_below[n] = below;
    }
    // dy*R0 - dx*R1 is edge x q.
    const auto tie = hn::Gt(FirstNonzero(CrossOf(Minus(v[next], v[n]), q)), zero);
    Ints value = zero, rest = hn::IfThenElse(tie, zero, Fill(-1));
    AddProduct(dx, hn::Sub(from_b, y[n]), value, rest);
    AddProduct(dy, hn::Sub(x[n], from_a), value, rest);
    out.edge[n] = hn::Add(value, hn::ShiftRight<kSubvoxelBits>(rest));
    out.edge_a[n] = hn::Neg(dy);
    out.edge_b[n] = dx;
    out.rim[n] = kCover ? CoverRim(rim, frames.cell.parts) : hn::ShiftRight<1>(hn::Add(rim, one));
  }

  MakeDepths(frames, pick, boxes, out);
}

// For ScanSingle (core/scan/scan_single-inl.h): the shapes of blocks, and the triangles with lines whose voxels lie
// beyond the box's bounds.
HWY_INLINE void PrepareBlocks(const FrameTable& frames, const Vec3i& size, LineScanLanes& s) {
  const Lanes d;
  const hn::RebindToFloat<Lanes> df;
  const auto load = [&](const LaneInts& ints) HWY_ATTR { return hn::Load(d, ints.of); };
  const auto to_float = [&](Ints i) HWY_ATTR { return hn::ConvertTo(df, i); };
  const Ints zero = hn::Zero(d), one = Fill(1);
  const Ints width = load(s.width), height = load(s.height), along = load(s.along);
  const Ints level_a = load(s.level_a), level_b = load(s.level_b);

  // The shape that needs the fewest blocks.
  Ints shape = zero, wide = zero, high = zero, fewest = Fill(INT32_MAX);
  for (int32_t n = 0; n < kShapes; ++n) {
    const int32_t block_width = BlockWidth<int32_t>(n);
    const Ints blocks = hn::Mul(
        hn::ShiftRightSame(hn::Add(width, Fill(block_width - 1)), std::countr_zero(static_cast<uint32_t>(block_width))),
        hn::ShiftRightSame(hn::Add(height, Fill((1 << n) - 1)), n));
    const auto fewer = hn::Lt(blocks, fewest);
    fewest = hn::Min(blocks, fewest);
    shape = hn::IfThenElse(fewer, Fill(n), shape);
    wide = hn::IfThenElse(fewer, Fill(block_width), wide);
    high = hn::IfThenElse(fewer, Fill(1 << n), high);
  }
  s.shape = shape;
  const auto slope_a = hn::Div(to_float(level_a), to_float(along)),
             slope_b = hn::Div(to_float(level_b), to_float(along));
  Ints depth_step, remainder;
  Divide(d, hn::Mul(level_a, wide), hn::Mul(slope_a, to_float(wide)), along, depth_step, remainder);
  s.right_depth = depth_step;
  s.right_remainder = remainder;
  Divide(d, hn::Mul(level_b, high), hn::Mul(slope_b, to_float(high)), along, depth_step, remainder);
  s.down_depth = depth_step;
  s.down_remainder = remainder;

  // As in LinesInBox: coordinates of the voxels are linear over the lines, except for the depth's rounding down. One
  // more for rounding here.
  const FramePick pick(load(s.frame));
  const Ints3 q = pick(frames.q), u0 = pick(frames.u[0]), u1 = pick(frames.u[1]);
  const Ints a = load(s.a), b = load(s.b), depth = load(s.depth);
  const auto to_last_a = to_float(hn::Sub(width, one)), to_last_b = to_float(hn::Sub(height, one));
  const auto nothing = hn::Zero(df);
  for (size_t m = 0; m < 3; ++m) {
    const auto per_q = to_float(q[m]);
    const auto base = to_float(hn::Add(hn::Add(hn::Mul(a, u0[m]), hn::Mul(b, u1[m])), hn::Mul(depth, q[m])));
    const auto over_a = hn::Mul(to_last_a, hn::Add(to_float(u0[m]), hn::Mul(slope_a, per_q)));
    const auto over_b = hn::Mul(to_last_b, hn::Add(to_float(u1[m]), hn::Mul(slope_b, per_q)));
    const auto slack = hn::IfThenElseZero(hn::Ne(per_q, nothing), hn::Add(hn::Abs(per_q), hn::Set(df, 1.0F)));
    const auto lower = hn::Sub(hn::Add(base, hn::Add(hn::Min(over_a, nothing), hn::Min(over_b, nothing))), slack);
    const auto upper = hn::Add(hn::Add(base, hn::Add(hn::Max(over_a, nothing), hn::Max(over_b, nothing))), slack);
    const auto inside = hn::And(hn::Ge(lower, nothing), hn::Le(upper, hn::Set(df, static_cast<float>(size[m] - 1))));
    s.astride[m] = BitsOf(hn::Not(hn::RebindMask(d, inside)));
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#endif
