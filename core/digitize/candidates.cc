// Triangles are set up one a lane. Those of few lines then go through their lines together, sorted so that these are
// about as many; the others one by one, in blocks of as many lines as there are lanes.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/digitize/candidates.cc"
#include "core/digitize/candidates.h"

#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <utility>

#include "core/digitize/line_blocks-inl.h"
#include "core/digitize/line_scan.h"
#include "core/digitize/line_scan_lanes-inl.h"
#include "core/snap/padded_vertices.h"

namespace latvox {
#ifndef LATVOX_CORE_DIGITIZE_CANDIDATES_CC_ONCE
#define LATVOX_CORE_DIGITIZE_CANDIDATES_CC_ONCE
namespace {

// One triangle and line at a time: what the lanes below are tested against.
size_t FindScalar(const SnappedMesh& mesh, std::span<const uint32_t> triangles, const std::vector<ScanFrame>& frames,
                  const IndexBox& box, const BitsLayout& layout, const std::atomic<bool>& cancelled, size_t enough,
                  Candidates& out) {
  size_t n = 0;
  for (; n < triangles.size() && out.size() < enough && !cancelled; ++n) {
    const uint32_t t = triangles[n];
    const auto& [v0, v1, v2] = mesh.triangles[t];
    const OrientedTriangle triangle({mesh.vertices_lat[v0], mesh.vertices_lat[v1], mesh.vertices_lat[v2]});
    if (triangle.normal == Vec<int64_t, 3>{}) continue;
    const auto crossed = [&](const Vec3i& nearer, const Vec3i& farther) {
      out.Reserve(1);
      out.nearer.Add(layout.NumberOf(nearer));
      out.farther.Add(layout.NumberOf(farther));
    };
    const auto rim = [&](const Vec3i& z) {
      out.Reserve(1);
      out.rim.Add(layout.NumberOf(z));
    };
    ScanAlongPrincipal(triangle, PrincipalScanFrame(frames, triangle.normal), box, crossed, rim);
    out.EndRun(triangles.subspan(n, 1));
  }
  return n;
}

}  // namespace
#endif
}  // namespace latvox

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET == HWY_SCALAR
size_t FindInLanes(const SnappedMesh& mesh, std::span<const uint32_t> triangles, const std::vector<ScanFrame>& frames,
                   const IndexBox& box, const BitsLayout& layout, const std::atomic<bool>& cancelled, size_t enough,
                   Candidates& out) {
  return FindScalar(mesh, triangles, frames, box, layout, cancelled, enough, out);
}
#else

namespace hn = hwy::HWY_NAMESPACE;

// Triangles too large for LineBoxes.
HWY_NOINLINE void ScanLarge(const Triangle& v, size_t place, const std::vector<ScanFrame>& frames, const NearBox& near,
                            const Target& target, Candidates& out) {
  const OrientedTriangle triangle(v);
  if (triangle.normal == Vec<int64_t, 3>{}) return;
  const ScanFrame& scan = PrincipalScanFrame(frames, triangle.normal);
  LineScan<int64_t> lines;
  if (!MakeLineScan(triangle, scan, {{}, target.size}, near, lines)) return;
  const LinesInBox in_box(lines, scan.frame, target.size);
  for (const bool rounded : {true, false}) {
    LineScan<int32_t> narrow;
    if (!Narrow(lines, rounded, narrow)) continue;
    ChooseShape(narrow);
    if (ScanLines(narrow, in_box.astride(), &in_box, place, scan.frame, target, out)) return;
  }
  ChooseShape(lines);
  ScanLines(lines, in_box.astride(), &in_box, place, scan.frame, target, out);
}

// Triangles with few lines each, one a lane: line after line of all.
constexpr int32_t kFewLines = 14;  // along a and b

//   which           the lanes that take part
//   lowest, highest voxels beyond these coordinates have no half-edge that meets the triangle, or are not wanted
void ScanTogether(const LineScanLanes& s, uint64_t which, const Ints3& lowest, const Ints3& highest,
                  const FrameTable& table, const Target& target, Candidates& out) {
  const Lanes d;
  const hn::RebindToFloat<Lanes> df;
  const auto load = [&](const LaneInts& ints) HWY_ATTR { return hn::Load(d, ints.of); };
  const auto some = hn::LoadMaskBits(d, reinterpret_cast<const uint8_t*>(&which));
  const Ints lines_a = hn::IfThenElseZero(some, load(s.width)), lines_b = hn::IfThenElseZero(some, load(s.height));
  // Rows go along the axis of more lines, whichever that is of a lane's: then the lanes' rows are about as long.
  const auto turned = hn::Gt(lines_b, lines_a);
  const Ints width = hn::Max(lines_a, lines_b), height = hn::Min(lines_a, lines_b);
  const auto most = [&](Ints v) HWY_ATTR { return hn::GetLane(hn::MaxOfLanes(d, v)); };
  const int32_t last_a = most(width), last_b = most(height);
  Appender appender(out, static_cast<size_t>(last_a) * static_cast<size_t>(last_b) * kTriangleLanes);

  const FramePick pick(load(s.frame));
  const Ints along = load(s.along), below_along = hn::Sub(along, Fill(1)), below_half = hn::Sub(load(s.half), Fill(1));
  const auto number_of = [&](const Ints3& ijk) HWY_ATTR {
    return hn::Add(
        hn::Add(hn::Mul(ijk[0], Fill(target.layout.stride[0])), hn::Mul(ijk[1], Fill(target.layout.stride[1]))),
        ijk[2]);
  };
  const Ints3 q = pick(table.q), u0 = pick(table.u[0]), u1 = pick(table.u[1]);
  const Ints step = number_of(q);
  struct State {
    Ints edge[3], remainder, number;
    Ints3 ijk;
  };
  // The step to the next line along u.
  const auto step_of = [&](const LaneInts(&edge)[3], const LaneInts& per_line, const Ints3& u) HWY_ATTR {
    State by;
    for (size_t n = 0; n < 3; ++n) by.edge[n] = load(edge[n]);
    const Ints level = load(per_line);
    Ints depth;
    Divide(d, level, hn::Div(hn::ConvertTo(df, level), hn::ConvertTo(df, along)), along, depth, by.remainder);
    for (size_t m = 0; m < 3; ++m) by.ijk[m] = hn::Add(u[m], hn::Mul(depth, q[m]));
    by.number = number_of(by.ijk);
    return by;
  };
  const State along_a = step_of(s.edge_a, s.level_a, u0), along_b = step_of(s.edge_b, s.level_b, u1);
  const auto choose = [&](const State& if_turned, const State& else_) HWY_ATTR {
    State by;
    for (size_t n = 0; n < 3; ++n) {
      by.edge[n] = hn::IfThenElse(turned, if_turned.edge[n], else_.edge[n]);
      by.ijk[n] = hn::IfThenElse(turned, if_turned.ijk[n], else_.ijk[n]);
    }
    by.remainder = hn::IfThenElse(turned, if_turned.remainder, else_.remainder);
    by.number = hn::IfThenElse(turned, if_turned.number, else_.number);
    return by;
  };
  const State right = choose(along_b, along_a), down = choose(along_a, along_b);
  const auto advance = [&](State& state, const State& by) HWY_ATTR {
    for (size_t n = 0; n < 3; ++n) state.edge[n] = hn::Add(state.edge[n], by.edge[n]);
    const Ints remainder = hn::Add(state.remainder, by.remainder);
    const auto carry = hn::Gt(remainder, below_along);
    state.remainder = hn::Sub(remainder, hn::IfThenElseZero(carry, along));
    state.number = hn::Add(hn::Add(state.number, by.number), hn::IfThenElseZero(carry, step));
    for (size_t m = 0; m < 3; ++m) {
      state.ijk[m] = hn::Add(hn::Add(state.ijk[m], by.ijk[m]), hn::IfThenElseZero(carry, q[m]));
    }
  };

  State row;
  Ints below_rim[3];
  for (size_t n = 0; n < 3; ++n) {
    row.edge[n] = load(s.edge[n]);
    below_rim[n] = hn::Sub(Fill(-1), load(s.rim[n]));
  }
  row.remainder = load(s.remainder);
  for (size_t m = 0; m < 3; ++m) {
    row.ijk[m] = hn::Add(hn::Add(hn::Mul(load(s.a), u0[m]), hn::Mul(load(s.b), u1[m])), hn::Mul(load(s.depth), q[m]));
  }
  row.number = hn::Add(hn::Add(number_of(row.ijk), Fill(target.number)), hn::ShiftLeft<kNumberBits>(hn::Iota(d, 0)));
  for (int32_t b = 0; b < last_b; ++b, advance(row, down)) {
    const auto in_height = hn::Gt(height, Fill(b));
    State line = row;
    for (int32_t a = 0; a < last_a; ++a, advance(line, right)) {
      auto candidate = hn::And(in_height, hn::Gt(width, Fill(a)));
      for (size_t n = 0; n < 3; ++n) candidate = hn::And(candidate, hn::Gt(line.edge[n], below_rim[n]));
      for (size_t m = 0; m < 3; ++m) {
        const Ints within = hn::Or(hn::Sub(line.ijk[m], lowest[m]), hn::Sub(highest[m], line.ijk[m]));
        candidate = hn::And(candidate, hn::Gt(within, Fill(-1)));
      }
      if (hn::AllFalse(d, candidate)) continue;
      const auto inside = hn::Gt(hn::Or(hn::Or(line.edge[0], line.edge[1]), line.edge[2]), Fill(-1));
      const Ints to_farther = hn::IfThenElse(hn::Gt(line.remainder, below_half), step, hn::Neg(step));
      appender.Append(d, line.number, to_farther, hn::And(candidate, inside), hn::AndNot(inside, candidate));
    }
  }
}

// What all triangles of a box have in common.
struct Scan {
  const SnappedMesh& mesh;
  PaddedVertices vertices;
  const std::vector<ScanFrame>& frames;
  FrameTable table;
  int32_t narrow;  // NarrowExtent
  Vec3i origin;    // of the box, lattice units
  Target target;
};

// Candidates that are looked for at a time, about, and triangles at least.
constexpr size_t kAtOnce = size_t{1} << 16, kFewest = 16;
static_assert(kFewest % kTriangleLanes == 0);

// Up to kTriangleLanes triangles.
struct SomeTriangles {
  std::array<Ints3, 3> v;  // corners, by axis, in lattice units from the low corner of the box
  Ints3 lowest, highest;   // as ScanTogether wants them
  hn::Mask<Lanes> near;    // may have candidates in the box
  hn::Mask<Lanes> small;   // as LineBoxes wants them

  HWY_INLINE SomeTriangles(const Scan& scan, std::span<const uint32_t> triangles)
      : v(LoadCorners(scan.mesh, scan.vertices, LaneNumbers(triangles), scan.origin)) {
    const Lanes d;
    near = small = hn::FirstN(d, triangles.size());
    for (size_t m = 0; m < 3; ++m) {
      const Ints low = Least(v[0][m], v[1][m], v[2][m]), high = Most(v[0][m], v[1][m], v[2][m]);
      // The table's box begins at 0.
      const Ints half_step = Fill(-scan.table.near.min[m]), top = Fill(scan.target.size[m] - 1);
      const Ints first = hn::Sub(hn::Add(low, Fill(kLatticeUnit - 1)), half_step), last = hn::Add(high, half_step);
      lowest[m] = hn::Max(hn::ShiftRight<kSubvoxelBits>(first), hn::Zero(d));
      highest[m] = hn::Min(hn::ShiftRight<kSubvoxelBits>(last), top);
      near = hn::And(near, hn::Not(hn::Gt(lowest[m], highest[m])));
      small = hn::And(small, hn::Lt(hn::Sub(high, low), Fill(scan.narrow + 1)));
    }
  }

  HWY_INLINE LineBoxes Boxes(const Scan& scan) const { return {scan.table, v, hn::And(near, small)}; }
};

// Puts triangles of about as many lines side by side: lanes wait for the longest rows and columns of theirs.
class LinesOrder {
 public:
  static constexpr size_t kMost = 256;  // triangles: a first-level cache holds their corners until they are scanned

  // Whether it is expected to have saved more time than it took, the last time.
  bool pays() const { return pays_; }

  // Returns the first `count` triangles, up to kMost, in that order; valid until the next call.
  HWY_INLINE std::span<const uint32_t> Sort(const Scan& scan, std::span<const uint32_t> triangles, size_t count) {
    const Lanes d;
    const hn::Rebind<uint8_t, Lanes> bytes;
    Ints lines = hn::Zero(d);
    int32_t steps = 0;  // of all lanes, unsorted
    for (size_t n = 0; n < count; n += kTriangleLanes) {
      PrefetchCorners(scan.mesh, triangles.subspan(n));
      const SomeTriangles some(scan, triangles.subspan(n, std::min(kTriangleLanes, count - n)));
      const LineBoxes boxes = some.Boxes(scan);
      const Ints longer = hn::Max(boxes.width, boxes.height), shorter = hn::Min(boxes.width, boxes.height);
      const auto valid = hn::LoadMaskBits(d, reinterpret_cast<const uint8_t*>(&boxes.valid));
      const auto few = hn::And(valid, hn::Lt(longer, Fill(kFewLines + 1)));
      const auto most = [&](Ints v) HWY_ATTR { return hn::GetLane(hn::MaxOfLanes(d, hn::IfThenElseZero(few, v))); };
      steps += most(longer) * most(shorter);
      lines = hn::Add(lines, hn::IfThenElseZero(few, hn::Mul(longer, shorter)));
      const Ints key = hn::Add(hn::Mul(longer, Fill(kFewLines + 1)), shorter);
      hn::StoreU(hn::DemoteTo(bytes, hn::IfThenElse(few, key, Fill(kKeys - 1))), bytes, keys_ + n);
    }
    // Sorted, lanes wait for a sixth of their time.
    const auto vectors = static_cast<int32_t>((count + kTriangleLanes - 1) / kTriangleLanes);
    const int32_t sorted_steps = hn::GetLane(hn::SumOfLanes(d, lines)) * 6 / (5 * static_cast<int32_t>(kTriangleLanes));
    pays_ = steps - sorted_steps > kStepsToSort * vectors;
    uint16_t ends[kKeys]{};
    for (size_t n = 0; n < count; ++n) ++ends[keys_[n]];
    uint16_t end = 0;
    for (uint16_t& size : ends) size = std::exchange(end, static_cast<uint16_t>(end + size));
    for (size_t n = 0; n < count; ++n) order_[ends[keys_[n]]++] = triangles[n];
    return {order_, count};
  }

 private:
  static constexpr size_t kKeys = (kFewLines + 1) * (kFewLines + 1) + 1;
  static_assert(kKeys <= 256);
  static constexpr int32_t kStepsToSort = 9;  // of a vector of triangles, which take as long as to sort it
  bool pays_ = true;
  uint8_t keys_[kMost + kTriangleLanes];
  uint32_t order_[kMost];
};

static_assert(kTriangleLanes <= Candidates::kMaxRun);
void ScanSome(const Scan& scan, std::span<const uint32_t> triangles, Candidates& out) {
  const Lanes d;
  const Target& target = scan.target;
  const SomeTriangles these(scan, triangles);
  LineScanLanes lines;
  const LineBoxes boxes = these.Boxes(scan);
  MakeLineScans(scan.table, boxes, lines);

  uint64_t together = 0;
  hn::StoreMaskBits(d, hn::Lt(hn::Max(boxes.width, boxes.height), Fill(kFewLines + 1)),
                    reinterpret_cast<uint8_t*>(&together));
  together &= lines.valid;
  if (static_cast<size_t>(std::popcount(together)) < kTriangleLanes / 4) together = 0;
  if (together != 0) ScanTogether(lines, together, these.lowest, these.highest, scan.table, target, out);
  const uint64_t by_themselves = lines.valid & ~together;
  if (by_themselves != 0) PrepareBlocks(scan.table, target.size, lines);
  for (uint64_t some = by_themselves; some != 0; some &= some - 1) {
    const auto t = static_cast<size_t>(std::countr_zero(some));
    uint32_t clip = 0;
    for (size_t m = 0; m < 3; ++m) clip |= static_cast<uint32_t>(lines.astride[m] >> t & 1) << m;
    ScanLines(lines.At(t), clip, nullptr, t, scan.frames[static_cast<size_t>(lines.frame.of[t])].frame, target, out);
  }
  uint64_t large = 0;
  hn::StoreMaskBits(d, hn::AndNot(these.small, these.near), reinterpret_cast<uint8_t*>(&large));
  for (; large != 0; large &= large - 1) {
    const auto t = static_cast<size_t>(std::countr_zero(large));
    Triangle triangle;
    for (size_t n = 0; n < 3; ++n) {
      const Vec3i& corner = scan.mesh.vertices_lat[scan.mesh.triangles[triangles[t]][n]];
      for (size_t m = 0; m < 3; ++m) triangle[n][m] = corner[m] - scan.origin[m];
    }
    ScanLarge(triangle, t, scan.frames, scan.table.near, target, out);
  }
}

size_t FindInLanes(const SnappedMesh& mesh, std::span<const uint32_t> triangles, const std::vector<ScanFrame>& frames,
                   const IndexBox& box, const BitsLayout& layout, const std::atomic<bool>& cancelled, size_t enough,
                   Candidates& out) {
  const Target target{box.max - box.min, layout, static_cast<int32_t>(layout.NumberOf(box.min))};
  const Vec3i low = box.min * kLatticeUnit;
  const Scan scan{mesh,  PaddedVertices(mesh), frames, FrameTable(frames, {{}, target.size}), NarrowExtent(frames), low,
                  target};
  LinesOrder order;
  constexpr size_t kTryAgain = 8;  // windows: whether sorting pays is seen by doing it
  size_t done = 0;
  for (size_t window = 0; done < triangles.size() && out.size() < enough && !cancelled; ++window) {
    // Each has up to some 50,000 candidates, or hardly any.
    const size_t step = std::clamp(kAtOnce * out.triangles.size() / (out.size() + 1), kFewest, LinesOrder::kMost) /
                        kTriangleLanes * kTriangleLanes;
    const auto left = triangles.subspan(done);
    auto some = left.first(std::min(step, left.size()));
    const bool sort = (order.pays() || window % kTryAgain == 0) && some.size() > kTriangleLanes;
    if (sort) some = order.Sort(scan, left, some.size());
    for (size_t n = 0; n < some.size() && !cancelled; n += kTriangleLanes) {
      if (!sort) PrefetchCorners(mesh, left.subspan(n));
      const auto lanes = some.subspan(n, std::min(kTriangleLanes, some.size() - n));
      ScanSome(scan, lanes, out);
      out.EndRun(lanes);
    }
    done += some.size();
  }
  return done;
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

size_t FindCandidates(const SnappedMesh& mesh, std::span<const uint32_t> triangles,
                      const std::vector<ScanFrame>& frames, const IndexBox& box, const BitsLayout& layout,
                      const std::atomic<bool>& cancelled, size_t enough, Candidates& candidates) {
  if (SimdIsScalar()) return FindScalar(mesh, triangles, frames, box, layout, cancelled, enough, candidates);
  return HWY_DYNAMIC_DISPATCH(FindInLanes)(mesh, triangles, frames, box, layout, cancelled, enough, candidates);
}

}  // namespace latvox
#endif  // HWY_ONCE
