// A triangle's lattice lines in the lanes, block after block, and where the candidates go that are found there.
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

// As PrepareBlocks does for lanes: whatever shape needs fewest blocks, and the steps of these.
template <class T>
void ChooseShape(LineScan<T>& s) {
  int32_t fewest = INT32_MAX;
  for (int32_t n = 0; n < kShapes && static_cast<int32_t>(HWY_LANES(T)) >> n > 0; ++n) {
    const int32_t wide = BlockWidth<T>(n), high = 1 << n;
    const int32_t blocks = ((s.width + wide - 1) / wide) * ((s.height + high - 1) / high);
    if (n == 0 || blocks < fewest) s.shape = n, fewest = blocks;
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

// Block after block of the triangle's lines.
//   clip    bit m: candidates may lie outside of the target on axis m
//   in_box  of large triangles, whose rows may have blocks without candidates before and behind; null: of others, whose
//           remainders are exact, too
// Returns false, and adds nothing, where the remainder of a candidate is in doubt.
template <class T, class InBox>
HWY_INLINE bool ScanSingle(const LineScan<T>& s, uint32_t clip, InBox in_box, size_t place, const Frame& frame,
                           const Target& target, Candidates& out) {
  constexpr bool kLarge = !std::is_null_pointer_v<InBox>;
  const hn::ScalableTag<T> d;
  using V = hn::Vec<decltype(d)>;
  const hn::RebindToFloat<decltype(d)> df;
  const auto all = [&](auto x) HWY_ATTR { return hn::Set(d, static_cast<T>(x)); };

  const int32_t wide = BlockWidth<T>(s.shape), high = 1 << s.shape;
  Appender appender(out, static_cast<size_t>(s.width + wide) * static_cast<size_t>(s.height + high));

  // What a line adds to the values of (s.a, s.b).
  const V along = all(s.along), minus_along = all(-s.along), below_along = all(s.along - 1),
          below_half = all(s.half - 1);
  using Float = hn::TFromD<decltype(df)>;
  const auto slope_a = hn::Set(df, static_cast<Float>(s.level_a) / static_cast<Float>(s.along));
  const auto slope_b = hn::Set(df, static_cast<Float>(s.level_b) / static_cast<Float>(s.along));
  const Vec3i steps{target.layout.StepOf(frame.u[0]), target.layout.StepOf(frame.u[1]), target.layout.StepOf(frame.q)};
  const V step = all(steps[2]);
  struct Lines {
    V edge[3], remainder, number, ijk[3];
  };
  const V a = hn::Load(d, kBlockLines<T>.a[s.shape]), b = hn::Load(d, kBlockLines<T>.b[s.shape]);
  const auto sum = [&](auto per_a, auto per_b)
                       HWY_ATTR { return hn::Add(hn::Mul(a, all(per_a)), hn::Mul(b, all(per_b))); };
  Lines row;
  for (size_t n = 0; n < 3; ++n) row.edge[n] = sum(s.edge_a[n], s.edge_b[n]);
  V depth;
  Divide(d, sum(s.level_a, s.level_b),
         hn::Add(hn::Mul(hn::ConvertTo(df, a), slope_a), hn::Mul(hn::ConvertTo(df, b), slope_b)), along, depth,
         row.remainder);
  row.number = hn::Add(sum(steps[0], steps[1]), hn::Mul(depth, step));
  for (size_t m = 0; m < 3; ++m) {
    row.ijk[m] = hn::Zero(d);
    if (clip >> m & 1) {
      row.ijk[m] = hn::Add(sum(frame.u[0][m], frame.u[1][m]), hn::Mul(depth, all(frame.q[m])));
    }
  }
  const auto advance = [&](Lines& lines, const Lines& by) HWY_ATTR {
    for (size_t n = 0; n < 3; ++n) lines.edge[n] = hn::Add(lines.edge[n], by.edge[n]);
    const V remainder = hn::Add(lines.remainder, by.remainder);
    const auto carry = hn::Gt(remainder, below_along);
    lines.remainder = AddIf(d, carry, remainder, minus_along);
    lines.number = AddIf(d, carry, hn::Add(lines.number, by.number), step);
    for (size_t m = 0; m < 3; ++m) {
      if (clip >> m & 1) lines.ijk[m] = AddIf(d, carry, hn::Add(lines.ijk[m], by.ijk[m]), all(frame.q[m]));
    }
  };

  // The same for all lanes: what `edges` and so on give.
  const auto same = [&](const std::array<T, 3>& edges, T remainder, const Vec3i& ijk, int32_t from) HWY_ATTR {
    Lines lines;
    for (size_t n = 0; n < 3; ++n) {
      lines.edge[n] = all(edges[n]);
      lines.ijk[n] = all(ijk[n]);
    }
    lines.remainder = all(remainder);
    lines.number = all(from + Dot(Vec<int64_t, 3>{ijk[0], ijk[1], ijk[2]}, target.layout.stride));
    return lines;
  };
  const auto ijk_of = [&](int64_t lines_a, int64_t lines_b, int32_t lines_depth) {
    Vec3i ijk;
    for (size_t m = 0; m < 3; ++m) {
      ijk[m] = static_cast<int32_t>(lines_a * frame.u[0][m] + lines_b * frame.u[1][m]) + lines_depth * frame.q[m];
    }
    return ijk;
  };
  advance(row, same(s.edge, s.remainder, ijk_of(s.a, s.b, s.depth), target.number));
  row.number = hn::Add(row.number, all(place << kNumberBits));
  Lines right = same(s.edge_a, s.right_remainder, ijk_of(wide, 0, s.right_depth), 0);
  Lines down = same(s.edge_b, s.down_remainder, ijk_of(0, high, s.down_depth), 0);
  for (size_t n = 0; n < 3; ++n) {  // in lanes, where lines that do not count may overflow
    right.edge[n] = hn::Mul(right.edge[n], all(wide));
    down.edge[n] = hn::Mul(down.edge[n], all(high));
  }
  const auto blocks_to_the_right = [&](int32_t blocks) HWY_ATTR {
    using Wide = std::conditional_t<sizeof(T) == 4, int64_t, __int128>;
    const Wide level = Wide{s.right_remainder} * blocks, carry = level / s.along;
    const int32_t to_depth = s.right_depth * blocks + static_cast<int32_t>(carry);
    Lines lines = same(s.edge_a, static_cast<T>(level - carry * s.along), ijk_of(wide * blocks, 0, to_depth), 0);
    for (V& edge : lines.edge) edge = hn::Mul(edge, all(wide * blocks));
    return lines;
  };
  V rim[3];
  for (size_t n = 0; n < 3; ++n) rim[n] = all(s.rim[n]);

  for (int32_t from_b = 0; from_b < s.height; from_b += high) {
    if (from_b != 0) advance(row, down);
    const auto in_height = hn::Lt(b, all(s.height - from_b));
    int32_t first_a = 0, end_a = s.width;
    Lines block = row;
    if constexpr (kLarge) {
      const auto [first, last] = in_box->Row(from_b, high);
      first_a = static_cast<int32_t>(first) & -wide;
      end_a = static_cast<int32_t>(last) + 1;
      if (first_a != 0 && first_a < end_a) advance(block, blocks_to_the_right(first_a / wide));
    }
    for (int32_t from_a = first_a; from_a < end_a; from_a += wide) {
      if (from_a != first_a) advance(block, right);
      const auto& e = block.edge;
      const V beyond_rim = hn::Or3(hn::Add(e[0], rim[0]), hn::Add(e[1], rim[1]), hn::Add(e[2], rim[2]));
      const auto in_width = hn::Lt(a, all(s.width - from_a));
      auto candidate = hn::AndNot(hn::Lt(beyond_rim, hn::Zero(d)), hn::And(in_height, in_width));
      if (kLarge && s.doubt != 0) {
        // From `doubt` below a multiple of `half`, which is half of `along`, a power of two, then.
        const V distance = hn::And(hn::Add(block.remainder, all(s.doubt)), all(s.half - 1));
        if (!hn::AllFalse(d, hn::And(candidate, hn::Lt(distance, all(2 * s.doubt + 1))))) {
          appender.Drop();
          return false;
        }
      }
      for (size_t m = 0; m < 3; ++m) {
        if (clip >> m & 1) {
          candidate =
              hn::And(candidate, hn::And(hn::Gt(block.ijk[m], all(-1)), hn::Lt(block.ijk[m], all(target.size[m]))));
        }
      }
      const auto beyond = hn::Lt(hn::Or3(e[0], e[1], e[2]), hn::Zero(d));
      const auto crossed = hn::AndNot(beyond, candidate), rim_only = hn::And(candidate, beyond);
      const V to_farther = hn::IfThenElse(hn::Gt(block.remainder, below_half), step, hn::Neg(step));
      appender.Append(d, block.number, to_farther, crossed, rim_only);
    }
  }
  return true;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#endif
