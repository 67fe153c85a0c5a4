// Scans triangles with few lattice lines each, one for each lane: line after line of all, or only lines within rims.
//
// The candidates are those of a scan line by line. A step adds exact integers to a lane's edges, remainder, number and
// counter. The remainders of line and step are both below `along`, so one carry is enough. So each line gets the values
// of core/scan/line_scan.h, whichever way leads to it. Floats only estimate quotients, which integers correct (Divide),
// or find spans within proved bounds (RowSpans). A lane whose rows have ended adds nothing, because its counter has a
// sign set (PackedCounter). Lanes that a counter or exact spans cannot hold are left to the caller, which scans them
// one by one with the same result. So neither the order of triangles nor the other triangles of a batch affect a
// triangle's candidates.
#if defined(LATVOX_CORE_SCAN_SCAN_BATCH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LATVOX_CORE_SCAN_SCAN_BATCH_INL_H_
#undef LATVOX_CORE_SCAN_SCAN_BATCH_INL_H_
#else
#define LATVOX_CORE_SCAN_SCAN_BATCH_INL_H_
#endif

#include <hwy/highway.h>

#include <span>

#include "core/scan/appender-inl.h"
#include "core/scan/batch_lines-inl.h"
#include "core/scan/line_scan_lanes-inl.h"
#include "core/scan/packed_counter-inl.h"
#include "core/scan/row_spans-inl.h"

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET != HWY_SCALAR

namespace hn = hwy::HWY_NAMESPACE;

// Triangles with more lines, along a or b, are scanned one by one (core/scan/scan_single-inl.h).
inline constexpr int32_t kFewLines = PackedCounter::kMostLines;
static_assert(kFewLines <= RowSpans::kMostLines);

// Rows of at least so many lines are worth a search for the lines within all rims. (Measured on AVX2, as PaysTogether.)
inline constexpr int32_t kLongRow = 12;

// Returns whether triangles of this many lines are scanned faster together than one by one.
HWY_INLINE bool PaysTogether(Ints width, Ints height, hn::Mask<Lanes> triangles) {
  const Lanes d;
  constexpr int32_t kStepsToBegin = 23;  // the cost of the beginning of one triangle, in lines of all lanes
  const auto most = [&](Ints v) HWY_ATTR { return MostOfLanes(hn::IfThenElseZero(triangles, v)); };
  const int32_t together = most(hn::Max(width, height)) * most(hn::Min(width, height));
  const int32_t lines = hn::GetLane(hn::SumOfLanes(d, hn::IfThenElseZero(triangles, hn::Mul(width, height))));
  // Blocks of lines are not quite full, and take longer.
  const int32_t blocks = lines * 5 / (3 * static_cast<int32_t>(kTriangleLanes));
  const auto count = static_cast<int32_t>(hn::CountTrue(d, triangles));
  return together < kStepsToBegin * count + blocks;
}

// Rows.

// The state of one line in each lane.
struct BatchLine {
  Ints edge[3], remainder;
  Ints number, counter;  // of the voxel, with the lane above it; PackedCounter
};

// Goes from line to line, and finds the candidates there.
template <bool kCover>
class BatchWalk {
 public:
  static constexpr bool kIsCover = kCover;

  HWY_INLINE explicit BatchWalk(const BatchLines& lines)
      : below_along_(hn::Sub(lines.along, Fill(1))),
        minus_along_(hn::Neg(lines.along)),
        below_half_(hn::Sub(lines.scans.half.Load(), Fill(1))),
        second_(kCover ? lines.scans.second.Load() : below_half_),
        sure_second_(kCover ? lines.scans.sure_second.Load() : below_half_),
        number_q_(lines.NumberOf(lines.q)),
        counter_q_(hn::IfThenElseZero(lines.some, PackedCounter::Coordinates(lines.q))),
        counter_(lines.limit),
        right_(StepOf(lines, lines.right, -1)),
        down_(StepOf(lines, lines.down, 0)) {}

  const BatchLine& right() const { return right_; }
  const BatchLine& down() const { return down_; }
  Ints number_q() const { return number_q_; }
  Ints counter_q() const { return counter_q_; }

  HWY_INLINE void Right(BatchLine& line) const { Advance(line, right_); }
  HWY_INLINE void Down(BatchLine& line) const { Advance(line, down_); }

  // A sign of PackedCounter is set where the voxel is not wanted, or the row has ended.
  HWY_INLINE Ints Outside(const BatchLine& line) const { return counter_.Signs(line.counter); }

  // Whether the plane is above the line's voxel.
  HWY_INLINE hn::Mask<Lanes> IsBelowPlane(const BatchLine& line) const { return hn::Gt(line.remainder, below_half_); }

  // Appends the lines' voxels.
  //   inner    the lines within all edges
  //   inside   of a supercover: the lines whose second voxel meets the triangle if its cell meets the plane
  HWY_INLINE void Append(const BatchLine& line, hn::Mask<Lanes> candidate, hn::Mask<Lanes> inner,
                         hn::Mask<Lanes> inside, Appender& appender) const {
    const auto crossed = hn::And(candidate, inner), rim_only = hn::AndNot(inner, candidate);
    const Ints to_farther = hn::IfThenElse(IsBelowPlane(line), number_q_, hn::Neg(number_q_));
    if constexpr (kCover) {
      const Ints distance = hn::Abs(hn::Add(hn::Add(line.remainder, line.remainder), minus_along_));
      const auto second = hn::And(candidate, hn::Gt(distance, second_));
      const auto sure = hn::And(second, hn::And(inside, hn::Gt(distance, sure_second_)));
      appender.AppendCover(Lanes(), line.number, to_farther, crossed, rim_only, sure, hn::AndNot(sure, second));
    } else {
      appender.Append(Lanes(), line.number, to_farther, crossed, rim_only);
    }
  }

 private:
  static HWY_INLINE BatchLine StepOf(const BatchLines& lines, const LineStep& by, int32_t to_come) {
    const Ints counter = hn::Add(PackedCounter::Coordinates(by.ijk), PackedCounter::Lines(Fill(to_come)));
    return {{by.edge[0], by.edge[1], by.edge[2]},
            by.remainder,
            lines.NumberOf(by.ijk),
            hn::IfThenElseZero(lines.some, counter)};
  }

  HWY_INLINE void Advance(BatchLine& line, const BatchLine& by) const {
    const Lanes d;
    for (size_t n = 0; n < 3; ++n) line.edge[n] = hn::Add(line.edge[n], by.edge[n]);
    const Ints remainder = hn::Add(line.remainder, by.remainder);
    const auto carry = hn::Gt(remainder, below_along_);
    const Ints number = hn::Add(line.number, by.number), counter = hn::Add(line.counter, by.counter);
    line.remainder = AddIf(d, carry, remainder, minus_along_);
    line.number = AddIf(d, carry, number, number_q_);
    line.counter = AddIf(d, carry, counter, counter_q_);
  }

  Ints below_along_, minus_along_, below_half_, second_, sure_second_;
  Ints number_q_, counter_q_;  // the changes by q
  PackedCounter counter_;
  BatchLine right_, down_;
};

// The first line of all, with no line to follow.
HWY_INLINE BatchLine FirstOf(const BatchLines& lines) {
  BatchLine line;
  for (size_t n = 0; n < 3; ++n) line.edge[n] = lines.scans.edge[n].Load();
  line.remainder = lines.scans.remainder.Load();
  line.number = hn::Add(hn::Add(lines.NumberOf(lines.first), Fill(lines.target.number)),
                        hn::ShiftLeft<kNumberBits>(hn::Iota(Lanes(), 0)));
  line.counter = PackedCounter::Coordinates(lines.above_lowest);
  return line;
}

// The beginning of a row without the lines beyond the rims.
struct BatchRow {
  LaneInts remainder, number, counter;
  // A part of the row: there the counter is below the first and above the second.
  struct Part {
    LaneInts before, behind;
  };
  Part inner;         // the lines within all edges
  Part above, below;  // of a supercover: those whose edge functions are enough (SecondVoxels)
  int32_t lines;
};

// The spans of a supercover's lines with enough edge functions (SecondVoxels). These are rims that are negative, or
// wider than the others by 2 at most.
template <bool kCover>
struct SecondSpans {
  HWY_INLINE explicit SecondSpans(const BatchLines&) {}
};
template <>
struct SecondSpans<true> {
  RowSpans above, below;

  HWY_INLINE explicit SecondSpans(const BatchLines& lines)
      : above(SpansOf(lines, lines.scans.enough_above)), below(SpansOf(lines, lines.scans.enough_below)) {}

 private:
  static HWY_INLINE RowSpans SpansOf(const BatchLines& lines, const LaneInts (&enough)[3]) {
    const Ints rim[3] = {hn::Neg(enough[0].Load()), hn::Neg(enough[1].Load()), hn::Neg(enough[2].Load())};
    return {lines.right.edge, rim, lines.boxes.width};
  }
};

// Finds the lanes' rows within their rims. A line outside of all rims is never a candidate (core/scan/line_scan.h), so
// skipping it leaves the result as it is.
template <class Walk>
class BatchRows {
 public:
  HWY_INLINE BatchRows(const BatchLines& lines, const Walk& walk, const RowSpans& spans)
      : lines_(lines), walk_(walk), spans_(spans), seconds_(lines), first_(FirstOf(lines)) {
    const hn::RebindToFloat<Lanes> df;
    per_along_ = hn::Div(hn::Set(df, 1.0F), ToFloat(lines.along));
    depth_right_ = hn::Mul(ToFloat(lines.right.remainder), per_along_);
    depth_down_ = hn::Mul(ToFloat(lines.down.remainder), per_along_);
    counter_right_ = hn::IfThenElseZero(lines.some, PackedCounter::Coordinates(lines.right.ijk));
    last_first_ = LastRowFirst(lines);
  }

  // Finds the b-th row in each lane's order.
  HWY_INLINE void Find(int32_t b, BatchRow& row) const {
    const Lanes d;
    const Ints zero = hn::Zero(d);
    const Ints height = lines_.boxes.height,
               down_by = hn::IfThenElse(last_first_, hn::Sub(height, Fill(b + 1)), Fill(b));
    Ints edge[3];
    for (size_t n = 0; n < 3; ++n) edge[n] = hn::Add(first_.edge[n], hn::Mul(down_by, lines_.down.edge[n]));
    const RowSpans::Spans spans = spans_.Of(edge);
    const Ints begin = spans.begin;
    const auto in_height = hn::And(lines_.some, hn::Gt(height, Fill(b)));
    const Ints count = hn::IfThenElseZero(in_height, hn::Max(hn::Sub(spans.end, begin), zero)),
               behind = hn::Add(begin, count);
    const auto moved = [&](Ints from, Ints by_down, Ints by_right) HWY_ATTR {
      return hn::Add(from, hn::Add(hn::Mul(down_by, by_down), hn::Mul(begin, by_right)));
    };
    Ints depth, remainder;
    Divide(d, moved(first_.remainder, lines_.down.remainder, lines_.right.remainder),
           hn::MulAdd(ToFloat(down_by), depth_down_,
                      hn::MulAdd(ToFloat(begin), depth_right_, hn::Mul(ToFloat(first_.remainder), per_along_))),
           lines_.along, depth, remainder);
    const Ints counter =
        hn::Add(moved(first_.counter, walk_.down().counter, counter_right_), hn::Mul(depth, walk_.counter_q()));
    row.remainder = remainder;
    row.number =
        hn::Add(moved(first_.number, walk_.down().number, walk_.right().number), hn::Mul(depth, walk_.number_q()));
    row.counter = hn::IfThenElse(hn::Gt(count, zero), hn::Add(counter, PackedCounter::Lines(hn::Sub(count, Fill(1)))),
                                 PackedCounter::None());
    const auto set = [&](BatchRow::Part& part, Ints first, Ints end) HWY_ATTR {
      part.before = PackedCounter::Lines(hn::Sub(behind, first));
      part.behind = hn::Sub(PackedCounter::Lines(hn::Sub(behind, end)), Fill(1));
    };
    set(row.inner, spans.inner_begin, spans.inner_end);
    if constexpr (Walk::kIsCover) {
      const RowSpans::Spans above = seconds_.above.Of(edge), below = seconds_.below.Of(edge);
      set(row.above, above.begin, above.end);
      set(row.below, below.begin, below.end);
    }
    row.lines = MostOfLanes(count);
  }

 private:
  using Floats = hn::Vec<hn::RebindToFloat<Lanes>>;
  static HWY_INLINE Floats ToFloat(Ints v) { return hn::ConvertTo(hn::RebindToFloat<Lanes>(), v); }

  // Rows are longest beside the corner that lies in the middle along a column. Lanes with that corner in the second
  // half begin with their last row, so that the rows of all lanes are long at about the same time. The corners' places
  // count from the first one, along `down` if turned, else against it. The middle one is sum - ends:
  static HWY_INLINE hn::Mask<Lanes> LastRowFirst(const BatchLines& lines) {
    const Ints zero = hn::Zero(Lanes());
    const Ints second = lines.right.edge[0], third = hn::Neg(lines.right.edge[2]);
    const Ints sum = hn::Add(second, third);  // of the three, from the first one
    const Ints ends = hn::Add(hn::Min(hn::Min(second, third), zero), hn::Max(hn::Max(second, third), zero));
    return hn::Xor(lines.boxes.turned, hn::Lt(hn::Add(sum, sum), hn::Add(ends, hn::Add(ends, ends))));
  }

  const BatchLines& lines_;
  const Walk& walk_;
  const RowSpans& spans_;
  const SecondSpans<Walk::kIsCover> seconds_;
  BatchLine first_;
  Floats per_along_, depth_right_, depth_down_;
  Ints counter_right_;
  hn::Mask<Lanes> last_first_;
};

// Emission.

// Room for candidates on all lines. A line of a supercover may add two of `nearer`.
template <bool kCover>
HWY_INLINE size_t MostCandidates(const BatchLines& lines) {
  const size_t steps = static_cast<size_t>(lines.boxes.longest) * static_cast<size_t>(lines.boxes.rows);
  return steps * kTriangleLanes * (kCover ? 2 : 1);
}

// Goes through all lines, and checks for each the sides of edges and rims.
template <bool kCover>
HWY_INLINE void ScanAllLines(const BatchLines& lines, Candidates& out) {
  const Ints zero = hn::Zero(Lanes()), minus_one = Fill(-1), negative = Fill(INT32_MIN);
  const Ints signs = Fill(static_cast<int32_t>(PackedCounter::kSigns));
  const BatchWalk<kCover> walk(lines);
  Appender appender(out, MostCandidates<kCover>(lines));
  Ints above[3], below[3];
  for (size_t n = 0; kCover && n < 3; ++n) {
    above[n] = lines.scans.enough_above[n].Load();
    below[n] = lines.scans.enough_below[n].Load();
  }
  BatchLine row = FirstOf(lines);
  row.counter = hn::Add(row.counter, PackedCounter::Lines(hn::Sub(lines.boxes.width, Fill(1))));
  for (int32_t b = 0; b < lines.boxes.rows; ++b, walk.Down(row)) {
    BatchLine line = row;
    const auto in_height = hn::And(lines.some, hn::Gt(lines.boxes.height, Fill(b)));
    line.counter = hn::IfThenElse(in_height, row.counter, PackedCounter::None());
    for (int32_t a = 0; a < lines.boxes.longest; ++a, walk.Right(line)) {
      const auto& e = line.edge;
      const Ints beyond_rim =
          hn::Or3(hn::Add(e[0], lines.rim[0]), hn::Add(e[1], lines.rim[1]), hn::Add(e[2], lines.rim[2]));
      const Ints out_of = hn::And(hn::OrAnd(walk.Outside(line), beyond_rim, negative), signs);
      const auto candidate = hn::Eq(out_of, zero), inner = hn::Gt(hn::Or3(e[0], e[1], e[2]), minus_one);
      auto inside = candidate;
      if constexpr (kCover) {
        const auto is_below = walk.IsBelowPlane(line);
        const auto over = [&](size_t n)
                              HWY_ATTR { return hn::Sub(e[n], hn::IfThenElse(is_below, above[n], below[n])); };
        inside = hn::Gt(hn::Or3(over(0), over(1), over(2)), minus_one);
      }
      walk.Append(line, candidate, inner, inside, appender);
    }
  }
}

// Goes through the lines within all rims, found by `spans`.
template <bool kCover>
HWY_INLINE void ScanSpans(const BatchLines& lines, const RowSpans& spans, Candidates& out) {
  const Ints zero = hn::Zero(Lanes()), signs = Fill(static_cast<int32_t>(PackedCounter::kSigns));
  const BatchWalk<kCover> walk(lines);
  Appender appender(out, MostCandidates<kCover>(lines));
  // The beginnings of all rows are found first. Nothing predicts the end of a row, and a mispredicted branch costs more
  // the longer it waits for its condition.
  BatchRow rows[kFewLines];
  const BatchRows<BatchWalk<kCover>> find(lines, walk, spans);
  for (int32_t b = 0; b < lines.boxes.rows; ++b) find.Find(b, rows[b]);
  for (const BatchRow& row : std::span(rows).first(static_cast<size_t>(lines.boxes.rows))) {
    const Ints before_inner = row.inner.before.Load(), behind_inner = row.inner.behind.Load();
    BatchLine line{{zero, zero, zero}, row.remainder.Load(), row.number.Load(), row.counter.Load()};
    for (int32_t a = 0; a < row.lines; ++a, walk.Right(line)) {
      const auto candidate = hn::Eq(hn::And(walk.Outside(line), signs), zero);
      const auto inner = hn::And(hn::Gt(before_inner, line.counter), hn::Gt(line.counter, behind_inner));
      auto inside = inner;
      if constexpr (kCover) {
        const auto is_below = walk.IsBelowPlane(line);
        const Ints before = hn::IfThenElse(is_below, row.above.before.Load(), row.below.before.Load());
        const Ints behind = hn::IfThenElse(is_below, row.above.behind.Load(), row.below.behind.Load());
        inside = hn::And(hn::Gt(before, line.counter), hn::Gt(line.counter, behind));
      }
      walk.Append(line, candidate, inner, inside, appender);
    }
  }
}

//   kBySpans        whether to go only through lines within all rims (RowSpans), or through all, with a check of each
//   kCover          whether the scan is that of a supercover
//   which           the lanes that take part
//   lowest, highest voxels beyond these coordinates have no half-link that meets the triangle, or are not wanted
// Returns the lanes that are done. It leaves out lanes that may have lines with voxels far away, and lanes with spans
// that are not exact.
template <bool kBySpans, bool kCover>
HWY_NOINLINE uint64_t ScanBatch(const LineScanLanes& scans, uint64_t which, const Ints3& lowest, const Ints3& highest,
                                const FrameTable& table, const Target& target, Candidates& out) {
  BatchLines lines(scans, which, lowest, highest, table, target);
  const RowSpans spans(lines.right.edge, lines.rim, lines.boxes.width);
  if constexpr (kBySpans) lines.some = hn::And(lines.some, spans.exact());
  const uint64_t done = BitsOf(lines.some);
  if (done == 0) return 0;
  if constexpr (kBySpans) {
    ScanSpans<kCover>(lines, spans, out);
  } else {
    ScanAllLines<kCover>(lines, out);
  }
  return done;
}

#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#endif
