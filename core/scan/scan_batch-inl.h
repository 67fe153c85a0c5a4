// Triangles with few lattice lines each, one a lane: line after line of all, or of each those within its rims.
#if defined(LATVOX_CORE_SCAN_SCAN_BATCH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LATVOX_CORE_SCAN_SCAN_BATCH_INL_H_
#undef LATVOX_CORE_SCAN_SCAN_BATCH_INL_H_
#else
#define LATVOX_CORE_SCAN_SCAN_BATCH_INL_H_
#endif

#include <hwy/highway.h>

#include <span>

#include "core/scan/candidates.h"
#include "core/scan/line_scan_lanes-inl.h"
#include "core/scan/row_spans-inl.h"
#include "core/scan/scan_single-inl.h"

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET != HWY_SCALAR

namespace hn = hwy::HWY_NAMESPACE;

// Triangles of more lines, along a or b, are scanned one by one (core/scan/scan_single-inl.h).
inline constexpr int32_t kFewLines = 56;
static_assert(kFewLines <= RowSpans::kMostLines);

// Of rows of so many lines, it pays to know those within all rims. (This and PaysTogether: on AVX2.)
inline constexpr int32_t kLongRow = 12;

// Whether triangles of so many lines are scanned faster together than one by one.
HWY_INLINE bool PaysTogether(Ints width, Ints height, hn::Mask<Lanes> triangles) {
  const Lanes d;
  constexpr int32_t kStepsToBegin = 23;  // what it takes to begin with one, in lines of all lanes
  const auto most = [&](Ints v) HWY_ATTR { return hn::GetLane(hn::MaxOfLanes(d, hn::IfThenElseZero(triangles, v))); };
  const int32_t together = most(hn::Max(width, height)) * most(hn::Min(width, height));
  const int32_t lines = hn::GetLane(hn::SumOfLanes(d, hn::IfThenElseZero(triangles, hn::Mul(width, height))));
  // Blocks of lines are not quite full, and take longer.
  const int32_t blocks = lines * 5 / (3 * static_cast<int32_t>(kTriangleLanes));
  const auto count = static_cast<int32_t>(hn::CountTrue(d, triangles));
  return together < kStepsToBegin * count + blocks;
}

// A line's voxel, relative to the lowest one wanted, and how many lines of the row are still to come: in fields of one
// integer, each a sum modulo what it has room for, below a bit that says that it is negative. What is negative takes 1
// from the field above; but then it says so itself. Lanes that have come to the end of their row go on, for less than
// as many lines again: coordinates may not fit then, but all together stay below 1 << kLinesShift, and so the lines
// below 0.
struct Packed {
  static constexpr int kBits = 8, kLinesShift = 3 * kBits;
  static constexpr int32_t kMost = (1 << (kBits - 1)) - 1;  // of a coordinate's size
  static constexpr uint32_t kNegative = 1U << 31 | 1U << (3 * kBits - 1) | 1U << (2 * kBits - 1) | 1U << (kBits - 1);
  static_assert(kFewLines <= 1 << (31 - kLinesShift));
  static_assert(2 * kMost * (1 + (1 << kBits) + (1 << 2 * kBits)) < 1 << kLinesShift);

  static HWY_INLINE Ints Of(const Ints3& ijk) {
    return hn::Add(hn::Add(ijk[0], hn::ShiftLeft<kBits>(ijk[1])), hn::ShiftLeft<2 * kBits>(ijk[2]));
  }
};

//   kBySpans        whether to go through lines within all rims alone (RowSpans), or through all, asking each
//   which           the lanes that take part
//   lowest, highest voxels beyond these coordinates have no half-edge that meets the triangle, or are not wanted
// Returns the lanes that are done: those that may have lines with voxels far away, or spans that are not exact, are
// left out.
template <bool kBySpans>
HWY_NOINLINE uint64_t ScanTogether(const LineScanLanes& s, uint64_t which, const Ints3& lowest, const Ints3& highest,
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
  Ints rim[3];
  for (size_t n = 0; n < 3; ++n) rim[n] = load(s.rim[n]);
  const RowSpans row_spans(right.edge, rim, width);
  if constexpr (kBySpans) some = hn::And(some, row_spans.exact());
  const uint64_t done = BitsOf(some);
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

  const Ints zero = hn::Zero(d), none = Fill(-1), negative = Fill(INT32_MIN),
             any_negative = Fill(static_cast<int32_t>(Packed::kNegative));
  State row;
  for (size_t n = 0; n < 3; ++n) row.edge[n] = load(s.edge[n]);
  row.remainder = load(s.remainder);
  row.number = hn::Add(hn::Add(number_of(first), Fill(target.number)), hn::ShiftLeft<kNumberBits>(hn::Iota(d, 0)));
  row.packed = Packed::Of(above_lowest);
  const auto to_come = [&](Ints lines) HWY_ATTR { return hn::ShiftLeft<Packed::kLinesShift>(lines); };
  const auto outside = [&](const State& line)
                           HWY_ATTR { return hn::Or(line.packed, hn::Sub(packed_room, line.packed)); };
  Appender appender(out, static_cast<size_t>(last_a) * static_cast<size_t>(last_b) * kTriangleLanes);
  const auto append = [&](const State& line, hn::Mask<Lanes> crossed, hn::Mask<Lanes> rim_only) HWY_ATTR {
    const Ints to_farther = hn::IfThenElse(hn::Gt(line.remainder, below_half), step, hn::Neg(step));
    appender.Append(d, line.number, to_farther, crossed, rim_only);
  };
  if constexpr (!kBySpans) {
    row.packed = hn::Add(row.packed, to_come(hn::Sub(width, Fill(1))));
    for (int32_t b = 0; b < last_b; ++b, advance(row, to_down)) {
      State line = row;
      line.packed = hn::IfThenElse(hn::And(some, hn::Gt(height, Fill(b))), row.packed, none);
      for (int32_t a = 0; a < last_a; ++a, advance(line, to_right)) {
        const auto& e = line.edge;
        const Ints beyond_rim = hn::Or3(hn::Add(e[0], rim[0]), hn::Add(e[1], rim[1]), hn::Add(e[2], rim[2]));
        const Ints out_of = hn::And(hn::OrAnd(outside(line), beyond_rim, negative), any_negative);
        const auto candidate = hn::Eq(out_of, zero), beyond = hn::Lt(hn::Or3(e[0], e[1], e[2]), zero);
        append(line, hn::AndNot(beyond, candidate), hn::And(candidate, beyond));
      }
    }
    return done;
  }

  // Where rows begin: first of all rows, since nothing predicts where one ends, and a branch taken wrongly costs more
  // the longer it waits for that.
  struct Row {
    LaneInts remainder, number, packed;
    LaneInts before_inner, behind_inner;  // `packed` is below the first and above the second within all edges
    int32_t lines;
  };
  Row rows[kFewLines];
  const auto to_float = [&](Ints v) HWY_ATTR { return hn::ConvertTo(df, v); };
  const auto per_along = hn::Div(hn::Set(df, 1.0F), to_float(along)),
             depth_right = hn::Mul(to_float(right.remainder), per_along),
             depth_down = hn::Mul(to_float(down.remainder), per_along);
  const Ints packed_right = hn::IfThenElseZero(some, Packed::Of(right.ijk));
  // Rows are longest beside the corner that is in the middle along a column. Lanes where that is in the second half
  // begin with their last row: then all are long at about the same time. Corners' places, from the first one's, along
  // `down` if turned, against it if not; the middle one is sum - ends:
  const Ints second = right.edge[0], third = hn::Neg(right.edge[2]);
  const Ints sum = hn::Add(second, third);  // of the three, from the first one
  const Ints ends = hn::Add(hn::Min(hn::Min(second, third), zero), hn::Max(hn::Max(second, third), zero));
  const auto last_first = hn::Xor(turned, hn::Lt(hn::Add(sum, sum), hn::Add(ends, hn::Add(ends, ends))));
  for (int32_t b = 0; b < last_b; ++b) {
    const Ints down_by = hn::IfThenElse(last_first, hn::Sub(height, Fill(b + 1)), Fill(b));
    Ints edge[3];
    for (size_t n = 0; n < 3; ++n) edge[n] = hn::Add(row.edge[n], hn::Mul(down_by, down.edge[n]));
    const RowSpans::Spans spans = row_spans.Of(edge);
    const Ints begin = spans.begin;
    const auto in_height = hn::And(some, hn::Gt(height, Fill(b)));
    const Ints lines = hn::IfThenElseZero(in_height, hn::Max(hn::Sub(spans.end, begin), zero)),
               behind = hn::Add(begin, lines);
    const auto moved = [&](Ints from, Ints by_down, Ints by_right) HWY_ATTR {
      return hn::Add(from, hn::Add(hn::Mul(down_by, by_down), hn::Mul(begin, by_right)));
    };
    Ints depth, remainder;
    Divide(d, moved(row.remainder, down.remainder, right.remainder),
           hn::MulAdd(to_float(down_by), depth_down,
                      hn::MulAdd(to_float(begin), depth_right, hn::Mul(to_float(row.remainder), per_along))),
           along, depth, remainder);
    const Ints packed = hn::Add(moved(row.packed, to_down.packed, packed_right), hn::Mul(depth, packed_q));
    Row& to = rows[b];
    to.remainder = remainder;
    to.number = hn::Add(moved(row.number, to_down.number, to_right.number), hn::Mul(depth, step));
    to.packed = hn::IfThenElse(hn::Gt(lines, zero), hn::Add(packed, to_come(hn::Sub(lines, Fill(1)))), none);
    to.before_inner = to_come(hn::Sub(behind, spans.inner_begin));
    to.behind_inner = hn::Sub(to_come(hn::Sub(behind, spans.inner_end)), Fill(1));
    to.lines = most(lines);
  }
  for (const Row& begin : std::span(rows).first(static_cast<size_t>(last_b))) {
    State line{{zero, zero, zero}, load(begin.remainder), load(begin.number), load(begin.packed)};
    const Ints before_inner = load(begin.before_inner), behind_inner = load(begin.behind_inner);
    for (int32_t a = 0; a < begin.lines; ++a, advance(line, to_right)) {
      const auto candidate = hn::Eq(hn::And(outside(line), any_negative), zero);
      const auto inner = hn::And(hn::Gt(before_inner, line.packed), hn::Gt(line.packed, behind_inner));
      append(line, hn::And(candidate, inner), hn::AndNot(inner, candidate));
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
