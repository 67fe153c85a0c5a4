// The lines of many triangles, one triangle for each lane: the set-up of core/scan/scan_batch-inl.h.
#if defined(LATVOX_CORE_SCAN_BATCH_LINES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LATVOX_CORE_SCAN_BATCH_LINES_INL_H_
#undef LATVOX_CORE_SCAN_BATCH_LINES_INL_H_
#else
#define LATVOX_CORE_SCAN_BATCH_LINES_INL_H_
#endif

#include <hwy/highway.h>

#include "core/scan/appender-inl.h"
#include "core/scan/line_scan_lanes-inl.h"
#include "core/scan/packed_counter-inl.h"

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET != HWY_SCALAR

namespace hn = hwy::HWY_NAMESPACE;

// Each lane's box of lines. Rows go along a lane's longer axis of lines, so that the lanes' rows are about equally
// long.
struct BatchBoxes {
  hn::Mask<Lanes> turned;  // rows go along b
  Ints width, height;      // lines of a row, and rows
  int32_t longest, rows;   // of all lanes

  HWY_INLINE BatchBoxes(const LineScanLanes& s, hn::Mask<Lanes> some) {
    const Ints lines_a = hn::IfThenElseZero(some, s.width.Load()), lines_b = hn::IfThenElseZero(some, s.height.Load());
    turned = hn::Gt(lines_b, lines_a);
    width = hn::Max(lines_a, lines_b);
    height = hn::Min(lines_a, lines_b);
    longest = MostOfLanes(width);
    rows = MostOfLanes(height);
  }
};

// The changes from one line to the next. Where the sum of remainders reaches `along`, the voxel moves by q, too.
struct LineStep {
  Ints edge[3], remainder;
  Ints3 ijk;  // of the voxel
};

HWY_INLINE LineStep StepAlong(const LaneInts (&edge)[3], const LaneInts& per_line, const Ints3& u, const Ints3& q,
                              Ints along) {
  const Lanes d;
  const hn::RebindToFloat<Lanes> df;
  const Ints level = per_line.Load();
  Ints depth, remainder;
  Divide(d, level, hn::Div(hn::ConvertTo(df, level), hn::ConvertTo(df, along)), along, depth, remainder);
  const auto moved = [&](size_t m) HWY_ATTR { return hn::Add(u[m], hn::Mul(depth, q[m])); };
  return {{edge[0].Load(), edge[1].Load(), edge[2].Load()}, remainder, {moved(0), moved(1), moved(2)}};
}

HWY_INLINE LineStep Choose(hn::Mask<Lanes> mask, const LineStep& yes, const LineStep& no) {
  const auto edge = [&](size_t n) HWY_ATTR { return hn::IfThenElse(mask, yes.edge[n], no.edge[n]); };
  const auto ijk = [&](size_t m) HWY_ATTR { return hn::IfThenElse(mask, yes.ijk[m], no.ijk[m]); };
  return {{edge(0), edge(1), edge(2)}, hn::IfThenElse(mask, yes.remainder, no.remainder), {ijk(0), ijk(1), ijk(2)}};
}

// The lines of all lanes: their first line, and the changes along a row (right) and from row to row (down).
struct BatchLines {
  const LineScanLanes& scans;
  const Target& target;
  hn::Mask<Lanes> some;  // lanes that take part
  BatchBoxes boxes;
  Ints along;
  Ints3 q, first;             // direction, and the first line's voxel
  Ints3 above_lowest, limit;  // the first voxel, and the highest wanted one, counted from the lowest wanted one
  LineStep right, down;
  Ints rim[3];

  HWY_INLINE BatchLines(const LineScanLanes& s, uint64_t which, const Ints3& lowest, const Ints3& highest,
                        const FrameTable& table, const Target& in)
      : scans(s),
        target(in),
        some(hn::LoadMaskBits(Lanes(), reinterpret_cast<const uint8_t*>(&which))),
        boxes(s, some),
        along(s.along.Load()) {
    const FramePick pick(s.frame.Load());
    q = pick(table.q);
    const Ints3 u0 = pick(table.u[0]), u1 = pick(table.u[1]);
    const LineStep along_a = StepAlong(s.edge_a, s.level_a, u0, q, along);
    const LineStep along_b = StepAlong(s.edge_b, s.level_b, u1, q, along);
    right = Choose(boxes.turned, along_b, along_a);
    down = Choose(boxes.turned, along_a, along_b);
    for (size_t m = 0; m < 3; ++m) {
      first[m] =
          hn::Add(hn::Add(hn::Mul(s.a.Load(), u0[m]), hn::Mul(s.b.Load(), u1[m])), hn::Mul(s.depth.Load(), q[m]));
      above_lowest[m] = hn::Sub(first[m], lowest[m]);
      limit[m] = hn::Sub(highest[m], lowest[m]);
      some = hn::And(some, FitsCounter(m));
    }
    for (size_t n = 0; n < 3; ++n) rim[n] = s.rim[n].Load();
  }

  // Returns whether PackedCounter can hold a coordinate on all lines. From line to line, no coordinate changes by more
  // than the step, and once more q.
  HWY_INLINE hn::Mask<Lanes> FitsCounter(size_t m) const {
    const auto largest = [&](Ints by) HWY_ATTR { return hn::Max(hn::Abs(by), hn::Abs(hn::Add(by, q[m]))); };
    const Ints farthest = hn::Add(hn::Abs(above_lowest[m]), hn::Add(hn::Mul(largest(right.ijk[m]), Fill(boxes.longest)),
                                                                    hn::Mul(largest(down.ijk[m]), Fill(boxes.rows))));
    return hn::Lt(hn::Max(farthest, limit[m]), Fill(PackedCounter::kMostCoordinate + 1));
  }

  // Returns the change of a voxel's number for a change of its coordinates.
  HWY_INLINE Ints NumberOf(const Ints3& ijk) const {
    return hn::Add(
        hn::Add(hn::Mul(ijk[0], Fill(target.layout.stride[0])), hn::Mul(ijk[1], Fill(target.layout.stride[1]))),
        ijk[2]);
  }
};

#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#endif
