// Triangles with few lattice lines each, one a lane: line after line of all.
#if defined(LATVOX_CORE_DIGITIZE_LINES_TOGETHER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LATVOX_CORE_DIGITIZE_LINES_TOGETHER_INL_H_
#undef LATVOX_CORE_DIGITIZE_LINES_TOGETHER_INL_H_
#else
#define LATVOX_CORE_DIGITIZE_LINES_TOGETHER_INL_H_
#endif

#include <hwy/highway.h>

#include "core/digitize/candidates.h"
#include "core/digitize/line_blocks-inl.h"
#include "core/digitize/line_scan_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET != HWY_SCALAR

namespace hn = hwy::HWY_NAMESPACE;

// Triangles of more lines, along a or b, are scanned one by one (core/digitize/line_blocks-inl.h).
inline constexpr int32_t kFewLines = 56;

// Whether triangles of so many lines are scanned faster together than one by one.
HWY_INLINE bool PaysTogether(Ints width, Ints height, hn::Mask<Lanes> triangles) {
  const Lanes d;
  constexpr int32_t kStepsToBegin = 16;  // what it takes to begin with one, in lines of all lanes
  const auto most = [&](Ints v) HWY_ATTR { return hn::GetLane(hn::MaxOfLanes(d, hn::IfThenElseZero(triangles, v))); };
  const int32_t together = most(hn::Max(width, height)) * most(hn::Min(width, height));
  const int32_t lines = hn::GetLane(hn::SumOfLanes(d, hn::IfThenElseZero(triangles, hn::Mul(width, height))));
  // Blocks of lines are not quite full.
  const int32_t blocks = lines * 8 / (7 * static_cast<int32_t>(kTriangleLanes));
  const auto count = static_cast<int32_t>(hn::CountTrue(d, triangles));
  return together < kStepsToBegin * count + blocks;
}

// A line's voxel, relative to the lowest one wanted, and how many lines of the row are still to come: in fields of one
// integer, each a sum modulo what it has room for, below a bit that says that it is negative. What is negative takes 1
// from the field above; but then it says so itself.
struct Packed {
  static constexpr int kBits = 8, kLinesShift = 3 * kBits;
  static constexpr int32_t kMost = (1 << (kBits - 1)) - 1;  // of a coordinate's size
  static constexpr uint32_t kNegative = 1U << 31 | 1U << (3 * kBits - 1) | 1U << (2 * kBits - 1) | 1U << (kBits - 1);
  static_assert(kFewLines <= 1 << (31 - kLinesShift));

  static HWY_INLINE Ints Of(const Ints3& ijk) {
    return hn::Add(hn::Add(ijk[0], hn::ShiftLeft<kBits>(ijk[1])), hn::ShiftLeft<2 * kBits>(ijk[2]));
  }
};

//   which           the lanes that take part
//   lowest, highest voxels beyond these coordinates have no half-edge that meets the triangle, or are not wanted
// Returns the lanes that are done: those that may have lines with voxels far away are left out.
HWY_INLINE uint64_t ScanTogether(const LineScanLanes& s, uint64_t which, const Ints3& lowest, const Ints3& highest,
                                 const FrameTable& table, const Target& target, Candidates& out) {
  const Lanes d;
  const hn::RebindToFloat<Lanes> df;
  const auto load = [&](const LaneInts& ints) HWY_ATTR { return hn::Load(d, ints.of); };
  auto some = hn::LoadMaskBits(d, reinterpret_cast<const uint8_t*>(&which));
  const Ints lines_a = hn::IfThenElseZero(some, load(s.width)), lines_b = hn::IfThenElseZero(some, load(s.height));
  // Rows go along the axis of more lines, whichever that is of a lane's: then the lanes' rows are about as long.
  const auto turned = hn::Gt(lines_b, lines_a);
  const Ints width = hn::Max(lines_a, lines_b), height = hn::Min(lines_a, lines_b);
  const auto most = [&](Ints v) HWY_ATTR { return hn::GetLane(hn::MaxOfLanes(d, v)); };
  const int32_t last_a = most(width), last_b = most(height);

  const FramePick pick(load(s.frame));
  const Ints along = load(s.along), below_along = hn::Sub(along, Fill(1)), below_half = hn::Sub(load(s.half), Fill(1));
  const auto number_of = [&](const Ints3& ijk) HWY_ATTR {
    return hn::Add(
        hn::Add(hn::Mul(ijk[0], Fill(target.layout.stride[0])), hn::Mul(ijk[1], Fill(target.layout.stride[1]))),
        ijk[2]);
  };
  const Ints3 q = pick(table.q), u0 = pick(table.u[0]), u1 = pick(table.u[1]);
  const Ints step = number_of(q);
  // The step to the next line along u.
  struct Step {
    Ints edge[3], remainder;
    Ints3 ijk;
  };
  const auto step_of = [&](const LaneInts(&edge)[3], const LaneInts& per_line, const Ints3& u) HWY_ATTR {
    Step by;
    for (size_t n = 0; n < 3; ++n) by.edge[n] = load(edge[n]);
    const Ints level = load(per_line);
    Ints depth;
    Divide(d, level, hn::Div(hn::ConvertTo(df, level), hn::ConvertTo(df, along)), along, depth, by.remainder);
    for (size_t m = 0; m < 3; ++m) by.ijk[m] = hn::Add(u[m], hn::Mul(depth, q[m]));
    return by;
  };
  const Step along_a = step_of(s.edge_a, s.level_a, u0), along_b = step_of(s.edge_b, s.level_b, u1);
  const auto choose = [&](const Step& if_turned, const Step& else_) HWY_ATTR {
    Step by;
    for (size_t n = 0; n < 3; ++n) {
      by.edge[n] = hn::IfThenElse(turned, if_turned.edge[n], else_.edge[n]);
      by.ijk[n] = hn::IfThenElse(turned, if_turned.ijk[n], else_.ijk[n]);
    }
    by.remainder = hn::IfThenElse(turned, if_turned.remainder, else_.remainder);
    return by;
  };
  const Step right = choose(along_b, along_a), down = choose(along_a, along_b);

  // The first line's voxel. From there no coordinate changes by more than a step's, and once more q, for each line.
  Ints3 first, above_lowest, room;
  for (size_t m = 0; m < 3; ++m) {
    first[m] = hn::Add(hn::Add(hn::Mul(load(s.a), u0[m]), hn::Mul(load(s.b), u1[m])), hn::Mul(load(s.depth), q[m]));
    above_lowest[m] = hn::Sub(first[m], lowest[m]);
    room[m] = hn::Sub(highest[m], lowest[m]);
    const auto largest = [&](Ints by) HWY_ATTR { return hn::Max(hn::Abs(by), hn::Abs(hn::Add(by, q[m]))); };
    const Ints farthest = hn::Add(hn::Abs(above_lowest[m]), hn::Add(hn::Mul(largest(right.ijk[m]), Fill(last_a)),
                                                                    hn::Mul(largest(down.ijk[m]), Fill(last_b))));
    some = hn::And(some, hn::Lt(hn::Max(farthest, room[m]), Fill(Packed::kMost + 1)));
  }
  uint64_t done = BitsOf(some);
  if (done == 0) return 0;

  struct State {
    Ints edge[3], remainder, number, packed;
  };
  const auto state_of = [&](const Step& by, int32_t lines) HWY_ATTR {
    const Ints packed = hn::Add(Packed::Of(by.ijk), Fill(lines * (1 << Packed::kLinesShift)));
    return State{
        {by.edge[0], by.edge[1], by.edge[2]}, by.remainder, number_of(by.ijk), hn::IfThenElseZero(some, packed)};
  };
  const State to_right = state_of(right, -1), to_down = state_of(down, 0);
  const Ints minus_along = hn::Neg(along), packed_q = hn::IfThenElseZero(some, Packed::Of(q)),
             most_lines = Fill((kFewLines - 1) << Packed::kLinesShift);
  const Ints packed_room = hn::Add(Packed::Of(room), most_lines);
  const auto advance = [&](State& state, const State& by) HWY_ATTR {
    for (size_t n = 0; n < 3; ++n) state.edge[n] = hn::Add(state.edge[n], by.edge[n]);
    const Ints remainder = hn::Add(state.remainder, by.remainder);
    const auto carry = hn::Gt(remainder, below_along);
    const Ints number = hn::Add(state.number, by.number), packed = hn::Add(state.packed, by.packed);
    state.remainder = AddIf(d, carry, remainder, minus_along);
    state.number = AddIf(d, carry, number, step);
    state.packed = AddIf(d, carry, packed, packed_q);
  };

  State row;
  Ints rim[3];
  for (size_t n = 0; n < 3; ++n) {
    row.edge[n] = load(s.edge[n]);
    rim[n] = load(s.rim[n]);
  }
  row.remainder = load(s.remainder);
  row.number = hn::Add(hn::Add(number_of(first), Fill(target.number)), hn::ShiftLeft<kNumberBits>(hn::Iota(d, 0)));
  row.packed = hn::Add(Packed::Of(above_lowest), hn::ShiftLeft<Packed::kLinesShift>(hn::Sub(width, Fill(1))));
  const Ints zero = hn::Zero(d), none = Fill(-1), negative = Fill(INT32_MIN),
             any_negative = Fill(static_cast<int32_t>(Packed::kNegative));
  Appender appender(out, static_cast<size_t>(last_a) * static_cast<size_t>(last_b) * kTriangleLanes);
  for (int32_t b = 0; b < last_b; ++b, advance(row, to_down)) {
    State line = row;
    line.packed = hn::IfThenElse(hn::And(some, hn::Gt(height, Fill(b))), row.packed, none);
    for (int32_t a = 0; a < last_a; ++a, advance(line, to_right)) {
      const auto& e = line.edge;
      const Ints beyond_rim = hn::Or3(hn::Add(e[0], rim[0]), hn::Add(e[1], rim[1]), hn::Add(e[2], rim[2]));
      const Ints outside = hn::Or(line.packed, hn::Sub(packed_room, line.packed));
      const Ints out_of = hn::And(hn::OrAnd(outside, beyond_rim, negative), any_negative);
      const auto candidate = hn::Eq(out_of, zero), beyond = hn::Lt(hn::Or3(e[0], e[1], e[2]), zero);
      const Ints to_farther = hn::IfThenElse(hn::Gt(line.remainder, below_half), step, hn::Neg(step));
      appender.Append(d, line.number, to_farther, hn::AndNot(beyond, candidate), hn::And(candidate, beyond));
    }
  }
  return done;
}

#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#endif
