// Scans the lattice lines of one triangle in lanes, block after block.
#if defined(LATVOX_CORE_SCAN_SCAN_SINGLE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LATVOX_CORE_SCAN_SCAN_SINGLE_INL_H_
#undef LATVOX_CORE_SCAN_SCAN_SINGLE_INL_H_
#else
#define LATVOX_CORE_SCAN_SCAN_SINGLE_INL_H_
#endif

#include <hwy/highway.h>

#include <type_traits>

#include "core/scan/appender-inl.h"
#include "core/scan/line_scan.h"
#include "core/scan/line_scan_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// Offsets of a block's lines from its first.
template <class T>
struct BlockLines {
  alignas(64) T a[kShapes][HWY_LANES(T)], b[kShapes][HWY_LANES(T)];
};
template <class T>
constexpr BlockLines<T> MakeBlockLines() {
  BlockLines<T> lines{};
  for (int32_t shape = 0; shape < kShapes; ++shape) {
    for (int32_t n = 0; n < static_cast<int32_t>(HWY_LANES(T)); ++n) {
      lines.a[shape][n] = n % BlockWidth<T>(shape);
      lines.b[shape][n] = n / BlockWidth<T>(shape);
    }
  }
  return lines;
}
template <class T>
inline constexpr BlockLines<T> kBlockLines = MakeBlockLines<T>();

// Like PrepareBlocks for lanes: sets the shape whose blocks are expected to take the least time, and the steps of
// blocks. Rows end where the triangle does, so a long thin triangle across the rows wants high blocks, and few rows.
// The row in the middle stands for all: its length is linear in its height. The fewest blocks of the whole rectangle
// say nothing of such a triangle: any shape has the same number of them in a square.
template <class T>
void ChooseShape(const LinesInBox& in_box, LineScan<T>& s) {
  constexpr int32_t kMostHigh = 1 << (kShapes - 1);
  const auto length = [&](int32_t high) {
    const auto [first, last] = in_box.Row(std::max(s.height - high, 0) / 2, high);
    return static_cast<float>(std::max<int64_t>(last - first + 1, 0));
  };
  const float low_row = length(1), per_line = (length(kMostHigh) - low_row) / (kMostHigh - 1);
  constexpr float kRow = 1.5F;  // the time to begin a row, in blocks
  float least = 0;
  for (int32_t n = 0; n < kShapes && static_cast<int32_t>(HWY_LANES(T)) >> n > 0; ++n) {
    const int32_t wide = BlockWidth<T>(n), high = 1 << n;
    const float blocks = (low_row + per_line * static_cast<float>(high - 1)) / static_cast<float>(wide) + 1;
    const float time = static_cast<float>((s.height + high - 1) / high) * (kRow + blocks);
    if (n == 0 || time < least) s.shape = n, least = time;
  }
  using Wide = std::conditional_t<sizeof(T) == 4, int64_t, __int128>;
  const auto divide = [&](Wide level, int32_t& depth, T& remainder) {
    const Wide quotient = level / s.along - (level % s.along < 0 ? 1 : 0);
    depth = static_cast<int32_t>(quotient);
    remainder = static_cast<T>(level - quotient * s.along);
  };
  divide(Wide{s.level_a} * BlockWidth<T>(s.shape), s.right_depth, s.right_remainder);
  divide(Wide{s.level_b} << s.shape, s.down_depth, s.down_remainder);
}

// The lines of one block, one a lane; or the step from one block to another. Where the sum of remainders reaches
// `along`, the voxel moves by q, too.
template <class T>
struct LineBlock {
  using V = hn::Vec<hn::ScalableTag<T>>;
  V edge[3], remainder, number;
  V ijk[3];  // of the voxel, on the axes of `clip` alone
};

// All lines of a triangle: the first block, the steps to others, and the decision on each line.
template <class T>
class SingleLines {
 public:
  using D = hn::ScalableTag<T>;
  using V = hn::Vec<D>;
  using M = hn::Mask<D>;
  using Block = LineBlock<T>;

  //   clip   bit m: candidates may lie outside of the target on axis m
  HWY_INLINE SingleLines(const LineScan<T>& scan, uint32_t clip, const Frame& frame, const Target& target)
      : scan_(scan),
        clip_(clip),
        frame_(frame),
        target_(target),
        wide_(BlockWidth<T>(scan.shape)),
        high_(1 << scan.shape),
        a_(hn::Load(D(), kBlockLines<T>.a[scan.shape])),
        b_(hn::Load(D(), kBlockLines<T>.b[scan.shape])),
        along_(All(scan.along)),
        minus_along_(All(-scan.along)),
        below_along_(All(scan.along - 1)),
        below_half_(All(scan.half - 1)),
        step_(All(target.layout.StepOf(frame.q))),
        rim_{All(scan.rim[0]), All(scan.rim[1]), All(scan.rim[2])} {}

  int32_t wide() const { return wide_; }
  int32_t high() const { return high_; }
  // The most candidates on all lines.
  size_t MostCandidates() const {
    return static_cast<size_t>(scan_.width + wide_) * static_cast<size_t>(scan_.height + high_);
  }

  // The block whose first line is (scan.a, scan.b), with `place` above the numbers of voxels.
  HWY_INLINE Block First(size_t place) const {
    Block first = WithinBlock();
    Advance(first, Same(scan_.edge, scan_.remainder, IjkOf(scan_.a, scan_.b, scan_.depth), target_.number));
    first.number = hn::Add(first.number, All(place << kNumberBits));
    return first;
  }
  // Edges step in lanes, where lines that do not count may overflow.
  HWY_INLINE Block Right() const {
    return Scaled(Same(scan_.edge_a, scan_.right_remainder, IjkOf(wide_, 0, scan_.right_depth), 0), wide_);
  }
  HWY_INLINE Block Down() const {
    return Scaled(Same(scan_.edge_b, scan_.down_remainder, IjkOf(0, high_, scan_.down_depth), 0), high_);
  }
  HWY_INLINE Block RightBy(int32_t blocks) const {
    using Wide = std::conditional_t<sizeof(T) == 4, int64_t, __int128>;
    const Wide level = Wide{scan_.right_remainder} * blocks, carry = level / scan_.along;
    const int32_t depth = scan_.right_depth * blocks + static_cast<int32_t>(carry);
    const auto remainder = static_cast<T>(level - carry * scan_.along);
    return Scaled(Same(scan_.edge_a, remainder, IjkOf(wide_ * blocks, 0, depth), 0), wide_ * blocks);
  }
  HWY_INLINE void Advance(Block& lines, const Block& by) const {
    for (size_t n = 0; n < 3; ++n) lines.edge[n] = hn::Add(lines.edge[n], by.edge[n]);
    const V remainder = hn::Add(lines.remainder, by.remainder);
    const auto carry = hn::Gt(remainder, below_along_);
    lines.remainder = AddIf(D(), carry, remainder, minus_along_);
    lines.number = AddIf(D(), carry, hn::Add(lines.number, by.number), step_);
    for (size_t m = 0; m < 3; ++m) {
      if (Clips(m)) lines.ijk[m] = AddIf(D(), carry, hn::Add(lines.ijk[m], by.ijk[m]), All(frame_.q[m]));
    }
  }

  // Lines of a block's first `rows` rows, and of its first `columns` columns.
  HWY_INLINE M InRows(int32_t rows) const { return hn::Lt(b_, All(rows)); }
  HWY_INLINE M InColumns(int32_t columns) const { return hn::Lt(a_, All(columns)); }

  HWY_INLINE M IsBeyondRim(const Block& lines) const {
    const auto& e = lines.edge;
    return hn::Lt(hn::Or3(hn::Add(e[0], rim_[0]), hn::Add(e[1], rim_[1]), hn::Add(e[2], rim_[2])), hn::Zero(D()));
  }
  // Whether the remainder of a candidate is less than `doubt` away from a multiple of `half`, which is half of `along`,
  // a power of two, wherever there is a doubt.
  HWY_INLINE bool IsInDoubt(const Block& lines, M candidate) const {
    const V distance = hn::And(hn::Add(lines.remainder, All(scan_.doubt)), All(scan_.half - 1));
    return !hn::AllFalse(D(), hn::And(candidate, hn::Lt(distance, All(2 * scan_.doubt + 1))));
  }
  HWY_INLINE M Clipped(const Block& lines, M candidate) const {
    for (size_t m = 0; m < 3; ++m) {
      if (!Clips(m)) continue;
      const auto& ijk = lines.ijk[m];
      candidate = hn::And(candidate, hn::And(hn::Gt(ijk, All(-1)), hn::Lt(ijk, All(target_.size[m]))));
    }
    return candidate;
  }
  HWY_INLINE void Append(const Block& lines, M candidate, Appender& appender) const {
    const auto& e = lines.edge;
    const M beyond = hn::Lt(hn::Or3(e[0], e[1], e[2]), hn::Zero(D()));
    const M crossed = hn::AndNot(beyond, candidate), rim_only = hn::And(candidate, beyond);
    const V to_farther = hn::IfThenElse(hn::Gt(lines.remainder, below_half_), step_, hn::Neg(step_));
    appender.Append(D(), lines.number, to_farther, crossed, rim_only);
  }

 private:
  template <class Value>
  static HWY_INLINE V All(Value value) {
    return hn::Set(D(), static_cast<T>(value));
  }
  bool Clips(size_t axis) const { return clip_ >> axis & 1; }
  HWY_INLINE V Sum(T per_a, T per_b) const { return hn::Add(hn::Mul(a_, All(per_a)), hn::Mul(b_, All(per_b))); }

  // The steps from a block's first line to each of its lines.
  HWY_INLINE Block WithinBlock() const {
    const hn::RebindToFloat<D> df;
    using Float = hn::TFromD<decltype(df)>;
    const auto slope = [&](T level) HWY_ATTR {
      return hn::Set(df, static_cast<Float>(level) / static_cast<Float>(scan_.along));
    };
    const Vec3i &u0 = frame_.u[0], &u1 = frame_.u[1];
    Block out;
    for (size_t n = 0; n < 3; ++n) out.edge[n] = Sum(scan_.edge_a[n], scan_.edge_b[n]);
    V depth;
    Divide(D(), Sum(scan_.level_a, scan_.level_b),
           hn::Add(hn::Mul(hn::ConvertTo(df, a_), slope(scan_.level_a)),
                   hn::Mul(hn::ConvertTo(df, b_), slope(scan_.level_b))),
           along_, depth, out.remainder);
    out.number = hn::Add(Sum(target_.layout.StepOf(u0), target_.layout.StepOf(u1)), hn::Mul(depth, step_));
    for (size_t m = 0; m < 3; ++m) {
      out.ijk[m] = hn::Zero(D());
      if (Clips(m)) out.ijk[m] = hn::Add(Sum(u0[m], u1[m]), hn::Mul(depth, All(frame_.q[m])));
    }
    return out;
  }
  // Has the same values in all lanes.
  HWY_INLINE Block Same(const std::array<T, 3>& edges, T remainder, const Vec3i& ijk, int32_t from) const {
    const int64_t number = from + Dot(Vec<int64_t, 3>{ijk[0], ijk[1], ijk[2]}, target_.layout.stride);
    return {{All(edges[0]), All(edges[1]), All(edges[2])},
            All(remainder),
            All(number),
            {All(ijk[0]), All(ijk[1]), All(ijk[2])}};
  }
  static HWY_INLINE Block Scaled(const Block& step, int32_t edges_by) {
    const V by = All(edges_by);
    return {{hn::Mul(step.edge[0], by), hn::Mul(step.edge[1], by), hn::Mul(step.edge[2], by)},
            step.remainder,
            step.number,
            {step.ijk[0], step.ijk[1], step.ijk[2]}};
  }
  Vec3i IjkOf(int64_t a, int64_t b, int32_t depth) const {
    Vec3i ijk;
    for (size_t m = 0; m < 3; ++m) {
      ijk[m] = static_cast<int32_t>(a * frame_.u[0][m] + b * frame_.u[1][m]) + depth * frame_.q[m];
    }
    return ijk;
  }

  const LineScan<T>& scan_;
  const uint32_t clip_;
  const Frame& frame_;
  const Target& target_;
  const int32_t wide_, high_;
  const V a_, b_, along_, minus_along_, below_along_, below_half_, step_, rim_[3];
};

// Goes through the triangle's lines, block after block and row after row of blocks.
//   clip    bit m: candidates may lie outside of the target on axis m
//   in_box  for large triangles, whose rows may begin and end with blocks without candidates; null: for others, which
//           also have exact remainders
// Returns false, and adds nothing, where the remainder of a candidate is in doubt.
template <class T, class InBox>
HWY_INLINE bool ScanSingle(const LineScan<T>& s, uint32_t clip, InBox in_box, size_t place, const Frame& frame,
                           const Target& target, Candidates& out) {
  constexpr bool kLarge = !std::is_null_pointer_v<InBox>;
  const SingleLines<T> lines(s, clip, frame, target);
  const int32_t wide = lines.wide(), high = lines.high();
  Appender appender(out, lines.MostCandidates());
  LineBlock<T> row = lines.First(place);
  const LineBlock<T> right = lines.Right(), down = lines.Down();
  for (int32_t from_b = 0; from_b < s.height; from_b += high) {
    if (from_b != 0) lines.Advance(row, down);
    const auto in_rows = lines.InRows(s.height - from_b);
    int32_t first_a = 0, end_a = s.width;
    LineBlock<T> block = row;
    if constexpr (kLarge) {
      const auto [first, last] = in_box->Row(from_b, high);
      first_a = static_cast<int32_t>(first) & -wide;
      end_a = static_cast<int32_t>(last) + 1;
      if (first_a != 0 && first_a < end_a) lines.Advance(block, lines.RightBy(first_a / wide));
    }
    for (int32_t from_a = first_a; from_a < end_a; from_a += wide) {
      if (from_a != first_a) lines.Advance(block, right);
      const auto in_triangle = hn::And(in_rows, lines.InColumns(s.width - from_a));
      const auto candidate = hn::AndNot(lines.IsBeyondRim(block), in_triangle);
      if (kLarge && s.doubt != 0 && lines.IsInDoubt(block, candidate)) {
        appender.Drop();
        return false;
      }
      lines.Append(block, lines.Clipped(block, candidate), appender);
    }
  }
  return true;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#endif
