// The lines of a row within a triangle's edges, or its rims, for many triangles, one for each lane.
#if defined(LATVOX_CORE_SCAN_ROW_SPANS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LATVOX_CORE_SCAN_ROW_SPANS_INL_H_
#undef LATVOX_CORE_SCAN_ROW_SPANS_INL_H_
#else
#define LATVOX_CORE_SCAN_ROW_SPANS_INL_H_
#endif

#include <hwy/highway.h>

#include "core/triangles/triangle_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET != HWY_SCALAR

namespace hn = hwy::HWY_NAMESPACE;

// The lines of a row of n lines within all rims (core/scan/line_scan.h), and those within all edges.
//
// Let e be an edge function of the row's first line, s its change from line to line, and r the rim, or 0: all integers.
// A negative rim selects lines that are so far within the edge.
// The lines a with e + r + s*a >= 0 are those with e + r + 1/2 + s*a > 0: for s > 0 those behind the place
// p = -(e + r + 1/2) / s, for s < 0 those before it. No line is closer to p than 1/(2|s|), so p + 1/2, rounded, is the
// first line behind p. It is computed as e * (-1/s) + ((r + 1/2) * (-1/s) + 1/2), in floats whose operations round to
// nearest. For a p among the lines, where e fits a float, it is wrong by less than 2^-24 * (3n + 5r/|s| + 9). That is
// less than 1/(2|s|) for n, |s| and r as below. The computed value never decreases as e grows, or never increases. So a
// p that is not among the lines comes out before or behind all of them.
class RowSpans {
 public:
  static constexpr int32_t kMostLines = 64;

  //   step, rim  of the three edges; rims may be negative
  //   lines      of a row, up to kMostLines
  HWY_INLINE RowSpans(const Ints (&step)[3], const Ints (&rim)[3], Ints lines) : lines_(ToFloats(lines)) {
    const Lanes d;
    const Floating df;
    exact_ = hn::FirstN(d, kTriangleLanes);
    const Floats half = hn::Set(df, 0.5F);
    for (size_t n = 0; n < 3; ++n) {
      // Where an edge function is constant, all lines are on one side. Then p is 512 lines before them if e + r >= 0,
      // and as far behind them otherwise.
      const auto constant = hn::RebindMask(df, hn::Eq(step[n], hn::Zero(d)));
      per_step_[n] = hn::IfThenElse(constant, hn::Set(df, -1024.0F), hn::Div(hn::Set(df, -1.0F), ToFloats(step[n])));
      rises_[n] = hn::RebindMask(df, hn::Gt(step[n], Fill(-1)));
      from_edge_[n] = hn::MulAdd(half, per_step_[n], half);
      from_rim_[n] = hn::MulAdd(hn::Add(ToFloats(rim[n]), half), per_step_[n], half);
      exact_ = hn::And(exact_, hn::And(hn::Lt(hn::Abs(step[n]), Fill(kMostStep)), hn::Lt(rim[n], Fill(kMostRim))));
    }
  }

  // The lanes with exact spans: |s| and r are small enough.
  HWY_INLINE hn::Mask<Lanes> exact() const { return exact_; }

  // Lines from begin to end, without end. All are 0 to n, but an end may lie before its beginning.
  struct Spans {
    Ints begin, end, inner_begin, inner_end;
  };
  // Returns the spans of the row whose first line has these edge functions.
  HWY_INLINE Spans Of(const Ints (&edge)[3]) const {
    const Floating df;
    Floats begin = hn::Zero(df), inner_begin = begin, end = lines_, inner_end = lines_;
    for (size_t n = 0; n < 3; ++n) {
      const Floats e = ToFloats(edge[n]);
      const auto cut = [&](Floats at, Floats& from, Floats& to) HWY_ATTR {
        from = hn::IfThenElse(rises_[n], hn::Max(from, at), from);
        to = hn::IfThenElse(rises_[n], to, hn::Min(to, at));
      };
      cut(hn::MulAdd(e, per_step_[n], from_rim_[n]), begin, end);
      cut(hn::MulAdd(e, per_step_[n], from_edge_[n]), inner_begin, inner_end);
    }
    return {Rounded(begin), Rounded(end), Rounded(inner_begin), Rounded(inner_end)};
  }

 private:
  static constexpr int32_t kMostStep = 1 << 15, kMostRim = 1 << 18;
  static_assert(2 * ((3 * kMostLines + 9) * kMostStep + 5 * kMostRim) < 1 << 24);
  using Floating = hn::RebindToFloat<Lanes>;
  using Floats = hn::Vec<Floating>;
  static HWY_INLINE Floats ToFloats(Ints v) { return hn::ConvertTo(Floating(), v); }

  // Takes fewer instructions than a conversion, which also handles values that do not fit. Added to 1.5 * 2^23, the
  // integer is in the low bits.
  HWY_INLINE Ints Rounded(Floats at) const {
    const Floating df;
    const Floats base = hn::Set(df, 0x1.8p23F);
    const Floats within = hn::Max(hn::Min(at, lines_), hn::Zero(df));
    return hn::Sub(hn::BitCast(Lanes(), hn::Add(within, base)), hn::BitCast(Lanes(), base));
  }

  Floats lines_, per_step_[3], from_rim_[3], from_edge_[3];
  hn::Mask<Floating> rises_[3];
  hn::Mask<Lanes> exact_;
};

#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#endif
