// Triangles are set up one for each lane. Most triangles with few lines then go through their lines together, sorted so
// that their numbers of lines are similar. The others go one by one, in blocks of as many lines as there are lanes.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/scan/candidates.cc"
#include "core/scan/candidates.h"

#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <span>
#include <utility>

#include "core/scan/line_scan.h"
#include "core/scan/line_scan_lanes-inl.h"
#include "core/scan/scan_batch-inl.h"
#include "core/scan/scan_single-inl.h"
#include "core/triangles/padded_vertices.h"

namespace latvox {
#ifndef LATVOX_CORE_DIGITIZE_CANDIDATES_CC_ONCE
#define LATVOX_CORE_DIGITIZE_CANDIDATES_CC_ONCE
namespace {

// One triangle and line at a time: the reference for the lanes below.
size_t FindScalar(const SnappedMesh& mesh, std::span<const uint32_t> triangles, const std::vector<ScanFrame>& frames,
                  const SearchLimits& limits, Candidates& out) {
  const BitsLayout& layout = limits.layout;
  size_t n = 0;
  for (; n < triangles.size() && out.size() < limits.enough && !limits.stop.Stopped(); ++n) {
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
    ScanAlongPrincipal(triangle, PrincipalScanFrame(frames, triangle.normal), limits.box, crossed, rim);
    out.EndRun(triangles.subspan(n, 1));
  }
  return n;
}

size_t LeaveAll(std::span<const uint32_t> triangles, std::vector<uint32_t>& left) {
  left.insert(left.end(), triangles.begin(), triangles.end());
  return triangles.size();
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
                   const SearchLimits& limits, Candidates& out) {
  return FindScalar(mesh, triangles, frames, limits, out);
}

size_t FindCoverInLanes(const SnappedMesh&, std::span<const uint32_t> triangles, const CoverShape&, const SearchLimits&,
                        Candidates&, std::vector<uint32_t>& left) {
  return LeaveAll(triangles, left);
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
    ChooseShape(in_box, narrow);
    if (ScanSingle(narrow, in_box.astride(), &in_box, place, scan.frame, target, out)) return;
  }
  ChooseShape(in_box, lines);
  ScanSingle(lines, in_box.astride(), &in_box, place, scan.frame, target, out);
}

// The facts that all triangles of a box share.
struct Scan {
  const SnappedMesh& mesh;
  PaddedVertices vertices;
  const std::vector<ScanFrame>& frames;
  FrameTable table;
  int32_t narrow;  // NarrowExtent
  Vec3i origin;    // of the box, lattice units
  Target target;
};

// The approximate number of candidates, and the least number of triangles, for one round.
constexpr size_t kAtOnce = size_t{1} << 16, kFewest = 16;
static_assert(kFewest % kTriangleLanes == 0);

// Up to kTriangleLanes triangles.
struct SomeTriangles {
  std::array<Ints3, 3> v;  // corners, by axis, in lattice units from the low corner of the box
  Ints3 lowest, highest;   // in the form for ScanBatch
  hn::Mask<Lanes> near;    // triangles that may have candidates in the box
  hn::Mask<Lanes> small;   // triangles that fit LineBoxes

  HWY_INLINE SomeTriangles(const Scan& scan, std::span<const uint32_t> triangles)
      : v(LoadCorners(scan.mesh, scan.vertices, LaneNumbers(triangles), scan.origin)) {
    const Lanes d;
    near = small = hn::FirstN(d, triangles.size());
    for (size_t m = 0; m < 3; ++m) {
      const Ints low = Least(v[0][m], v[1][m], v[2][m]), high = Most(v[0][m], v[1][m], v[2][m]);
      // The table's box begins at 0.
      const Ints reach = Fill(-scan.table.near.min[m]), top = Fill(scan.target.size[m] - 1);
      const Ints first = hn::Sub(hn::Add(low, Fill(kLatticeUnit - 1)), reach), last = hn::Add(high, reach);
      lowest[m] = hn::Max(hn::ShiftRight<kSubvoxelBits>(first), hn::Zero(d));
      highest[m] = hn::Min(hn::ShiftRight<kSubvoxelBits>(last), top);
      near = hn::And(near, hn::Not(hn::Gt(lowest[m], highest[m])));
      small = hn::And(small, hn::Lt(hn::Sub(high, low), Fill(scan.narrow + 1)));
    }
  }

  // Estimates the number of lines along both sides of their box, in less time than LineBoxes takes. It uses the extents
  // along the two axes that are farther from the normal.
  struct BoxSides {
    Ints longer, shorter;
  };
  HWY_INLINE BoxSides Sides() const {
    const Ints3 normal = CrossOf(Minus(v[1], v[0]), Minus(v[2], v[0]));
    Ints3 extent, slope;
    for (size_t m = 0; m < 3; ++m) {
      extent[m] = hn::Sub(hn::Add(highest[m], Fill(1)), lowest[m]);
      slope[m] = hn::Abs(normal[m]);
    }
    const auto along_1 = hn::Gt(slope[1], slope[0]), along_2 = hn::Gt(slope[2], hn::Max(slope[0], slope[1]));
    const Ints a = hn::IfThenElse(along_2, extent[1], extent[2]);
    const Ints b = hn::IfThenElse(hn::Or(along_1, along_2), extent[0], extent[1]);
    return {hn::Max(a, b), hn::Min(a, b)};
  }

  HWY_INLINE LineBoxes Boxes(const Scan& scan) const { return {scan.table, v, hn::And(near, small)}; }
};

// Sorts triangles by their number of lines, because lanes wait for the longest rows and columns of their vector.
class LinesOrder {
 public:
  static constexpr size_t kMost = 256;  // triangles; a first-level cache holds their corners until they are scanned

  static constexpr size_t kTryAgain = 8;  // windows; only a trial shows whether sorting pays

  // Whether the last sort is expected to have saved more time than it took.
  bool pays() const { return pays_; }

  // Returns the first `count` triangles, up to kMost, in sorted order; valid until the next call.
  HWY_INLINE std::span<const uint32_t> Sort(const Scan& scan, std::span<const uint32_t> triangles, size_t count) {
    const Lanes d;
    const hn::Rebind<uint16_t, Lanes> d16;
    Ints lines = hn::Zero(d), largest = lines;
    int32_t steps = 0;  // of all lanes, unsorted
    for (size_t n = 0; n < count; n += kTriangleLanes) {
      PrefetchCorners(scan.mesh, triangles.subspan(n));
      const SomeTriangles some(scan, triangles.subspan(n, std::min(kTriangleLanes, count - n)));
      const auto [longer, shorter] = some.Sides();
      const auto few = hn::And(hn::And(some.near, some.small), hn::Lt(longer, Fill(kFewLines + 1)));
      const auto most = [&](Ints v) HWY_ATTR { return hn::GetLane(hn::MaxOfLanes(d, hn::IfThenElseZero(few, v))); };
      steps += most(longer) * most(shorter);
      lines = hn::Add(lines, hn::IfThenElseZero(few, hn::Mul(longer, shorter)));
      const Ints key = hn::Add(hn::Mul(longer, Fill(kShorter)), hn::Add(hn::ShiftRight<1>(shorter), Fill(1)));
      const Ints key_or_0 = hn::IfThenElseZero(few, key);
      largest = hn::Max(largest, key_or_0);
      hn::StoreU(hn::DemoteTo(d16, key_or_0), d16, keys_ + n);
    }
    // Sorted, lanes wait for a sixth of their time.
    const auto vectors = static_cast<int32_t>((count + kTriangleLanes - 1) / kTriangleLanes);
    const int32_t sorted_steps = hn::GetLane(hn::SumOfLanes(d, lines)) * 6 / (5 * static_cast<int32_t>(kTriangleLanes));
    pays_ = steps - sorted_steps > kStepsToSort * vectors;
    uint16_t ends[kKeys]{};
    for (size_t n = 0; n < count; ++n) ++ends[keys_[n]];
    const auto used = static_cast<size_t>(hn::GetLane(hn::MaxOfLanes(d, largest))) + 1;
    uint16_t end = 0;
    for (uint16_t& size : std::span(ends).first(used)) size = std::exchange(end, static_cast<uint16_t>(end + size));
    for (size_t n = 0; n < count; ++n) order_[ends[keys_[n]]++] = triangles[n];
    return {order_, count};
  }

 private:
  // The key is 0 for triangles that are not expected to be scanned together. For others, the longer side counts first,
  // then half the shorter side.
  static constexpr size_t kShorter = kFewLines / 2 + 1, kKeys = 1 + (kFewLines + 1) * kShorter;
  static constexpr int32_t kStepsToSort = 9;  // the cost of sorting a vector of triangles, in steps
  bool pays_ = true;
  uint16_t keys_[kMost + kTriangleLanes];
  uint32_t order_[kMost];
};

static_assert(kTriangleLanes <= TriangleBoxes::kSlack);
HWY_INLINE void AddBoxes(const SomeTriangles& some, size_t count, TriangleBoxes& boxes) {
  const hn::Rebind<uint8_t, Lanes> bytes;
  boxes.Reserve(count);
  for (size_t m = 0; m < 3; ++m) {
    const Ints lowest = hn::IfThenElse(some.near, some.lowest[m], Fill(UINT8_MAX));  // else none
    const Ints highest = hn::IfThenElseZero(some.near, some.highest[m]);
    hn::StoreU(hn::DemoteTo(bytes, lowest), bytes, boxes.Lowest(m));
    hn::StoreU(hn::DemoteTo(bytes, highest), bytes, boxes.Highest(m));
  }
  boxes.Grow(count);
}

static_assert(kTriangleLanes <= Candidates::kMaxRun);
void ScanSome(const Scan& scan, std::span<const uint32_t> triangles, bool boxes_too, Candidates& out) {
  const Lanes d;
  const Target& target = scan.target;
  const SomeTriangles these(scan, triangles);
  LineScanLanes lines;
  if (boxes_too) AddBoxes(these, triangles.size(), out.boxes);
  const LineBoxes boxes = these.Boxes(scan);
  MakeLineScans(scan.table, boxes, nullptr, lines);

  const auto valid = hn::LoadMaskBits(d, reinterpret_cast<const uint8_t*>(&lines.valid));
  const auto few = hn::And(valid, hn::Lt(hn::Max(boxes.width, boxes.height), Fill(kFewLines + 1)));
  uint64_t together = PaysTogether(boxes.width, boxes.height, few) ? BitsOf(few) : 0;
  if (together != 0) {
    const Ints longer = hn::IfThenElseZero(few, hn::Max(boxes.width, boxes.height));
    const bool by_spans = hn::GetLane(hn::MaxOfLanes(d, longer)) >= kLongRow;
    const auto scan_batch = by_spans ? ScanBatch<true, false> : ScanBatch<false, false>;
    together = scan_batch(lines, together, these.lowest, these.highest, scan.table, target, out);
  }
  const uint64_t by_themselves = lines.valid & ~together;
  if (by_themselves != 0) PrepareBlocks(scan.table, target.size, lines);
  for (uint64_t some = by_themselves; some != 0; some &= some - 1) {
    const auto t = static_cast<size_t>(std::countr_zero(some));
    uint32_t clip = 0;
    for (size_t m = 0; m < 3; ++m) clip |= static_cast<uint32_t>(lines.astride[m] >> t & 1) << m;
    ScanSingle(lines.At(t), clip, nullptr, t, scan.frames[static_cast<size_t>(lines.frame.of[t])].frame, target, out);
  }
  for (uint64_t large = BitsOf(hn::AndNot(these.small, these.near)); large != 0; large &= large - 1) {
    const auto t = static_cast<size_t>(std::countr_zero(large));
    Triangle triangle;
    for (size_t n = 0; n < 3; ++n) {
      const Vec3i& corner = scan.mesh.vertices_lat[scan.mesh.triangles[triangles[t]][n]];
      for (size_t m = 0; m < 3; ++m) triangle[n][m] = corner[m] - scan.origin[m];
    }
    ScanLarge(triangle, t, scan.frames, scan.table.near, target, out);
  }
}

// Up to kTriangleLanes triangles of a supercover.
void ScanCover(const Scan& scan, std::span<const uint32_t> triangles, Candidates& out, std::vector<uint32_t>& left) {
  const SomeTriangles these(scan, triangles);
  const LineBoxes boxes = these.Boxes(scan);
  const SecondVoxels seconds(scan.table.cell, boxes.normal, boxes.along);
  LineScanLanes lines;
  MakeLineScans(scan.table, boxes, &seconds, lines);
  const uint64_t flat = BitsOf(hn::And(these.near, hn::Eq(boxes.along, hn::Zero(Lanes()))));
  uint64_t done = 0;
  if (lines.valid != 0) {
    const auto valid = hn::LoadMaskBits(Lanes(), reinterpret_cast<const uint8_t*>(&lines.valid));
    const Ints longer = hn::IfThenElseZero(valid, hn::Max(boxes.width, boxes.height));
    const auto has_two = hn::Gt(seconds.maybe(), Fill(-1));  // else h may reach n.C, and a line may have a third voxel
    const uint64_t some = BitsOf(hn::And(valid, hn::And(has_two, hn::Lt(longer, Fill(kFewLines + 1)))));
    const auto scan_batch = MostOfLanes(longer) >= kLongRow ? ScanBatch<true, true> : ScanBatch<false, true>;
    done = scan_batch(lines, some, these.lowest, these.highest, scan.table, scan.target, out);
  }
  const uint64_t large = BitsOf(hn::AndNot(these.small, these.near));
  for (uint64_t some = flat | large | (lines.valid & ~done); some != 0; some &= some - 1) {
    left.push_back(triangles[static_cast<size_t>(std::countr_zero(some))]);
  }
}

// Calls scan_lanes(triangles) for up to kTriangleLanes triangles at a time, and begin_window() before those of a
// window.
template <class BeginWindow, class ScanLanes>
HWY_INLINE size_t ScanWindows(const Scan& scan, std::span<const uint32_t> triangles, const SearchLimits& limits,
                              Candidates& out, const BeginWindow& begin_window, const ScanLanes& scan_lanes) {
  const StopSignal stop = limits.stop;
  LinesOrder order;
  size_t done = 0;
  for (size_t window = 0; done < triangles.size() && out.size() < limits.enough && !stop.Stopped(); ++window) {
    begin_window();
    // Each triangle has up to some 50,000 candidates, or hardly any.
    const size_t step = std::clamp(kAtOnce * out.triangles.size() / (out.size() + 1), kFewest, LinesOrder::kMost) /
                        kTriangleLanes * kTriangleLanes;
    const auto left = triangles.subspan(done);
    auto some = left.first(std::min(step, left.size()));
    const bool sort = (order.pays() || window % LinesOrder::kTryAgain == 0) && some.size() > kTriangleLanes;
    if (sort) some = order.Sort(scan, left, some.size());
    for (size_t n = 0; n < some.size() && !stop.Stopped(); n += kTriangleLanes) {
      if (!sort) PrefetchCorners(scan.mesh, left.subspan(n));
      const auto lanes = some.subspan(n, std::min(kTriangleLanes, some.size() - n));
      scan_lanes(lanes);
      out.EndRun(lanes);
    }
    done += some.size();
  }
  return done;
}

Target TargetOf(const SearchLimits& limits) {
  const IndexBox& box = limits.box;
  return {box.max - box.min, limits.layout, static_cast<int32_t>(limits.layout.NumberOf(box.min))};
}

size_t FindInLanes(const SnappedMesh& mesh, std::span<const uint32_t> triangles, const std::vector<ScanFrame>& frames,
                   const SearchLimits& limits, Candidates& out) {
  const Target target = TargetOf(limits);
  const Scan scan{mesh,
                  PaddedVertices(mesh),
                  frames,
                  FrameTable(frames, {{}, target.size}),
                  NarrowExtent(frames),
                  limits.box.min * kLatticeUnit,
                  target};
  constexpr size_t kForBoxes = 8;  // candidates for each triangle; from this number on, boxes may pay
  bool boxes_too = *std::max_element(target.size.begin(), target.size.end()) <= TriangleBoxes::kMostSide;
  const auto begin_window = [&] { boxes_too &= out.size() >= kForBoxes * out.triangles.size(); };
  const auto scan_lanes = [&](std::span<const uint32_t> lanes) { ScanSome(scan, lanes, boxes_too, out); };
  return ScanWindows(scan, triangles, limits, out, begin_window, scan_lanes);
}

size_t FindCoverInLanes(const SnappedMesh& mesh, std::span<const uint32_t> triangles, const CoverShape& shape,
                        const SearchLimits& limits, Candidates& out, std::vector<uint32_t>& left) {
  const Target target = TargetOf(limits);
  const Scan scan{mesh,
                  PaddedVertices(mesh),
                  shape.frames,
                  FrameTable(shape.frames, {{}, target.size}, shape.cell),
                  std::min(NarrowExtent(shape.frames), shape.most_extent),
                  limits.box.min * kLatticeUnit,
                  target};
  const auto scan_lanes = [&](std::span<const uint32_t> lanes) { ScanCover(scan, lanes, out, left); };
  return ScanWindows(
      scan, triangles, limits, out, [] {}, scan_lanes);
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
HWY_EXPORT(FindCoverInLanes);

}  // namespace

size_t FindCandidates(const SnappedMesh& mesh, std::span<const uint32_t> triangles,
                      const std::vector<ScanFrame>& frames, const SearchLimits& limits, Candidates& candidates) {
  if (SimdIsScalar()) return FindScalar(mesh, triangles, frames, limits, candidates);
  return HWY_DYNAMIC_DISPATCH(FindInLanes)(mesh, triangles, frames, limits, candidates);
}

size_t FindCoverCandidates(const SnappedMesh& mesh, std::span<const uint32_t> triangles, const CoverShape& shape,
                           const SearchLimits& limits, Candidates& candidates, std::vector<uint32_t>& left) {
  if (SimdIsScalar()) return LeaveAll(triangles, left);
  return HWY_DYNAMIC_DISPATCH(FindCoverInLanes)(mesh, triangles, shape, limits, candidates, left);
}

}  // namespace latvox
#endif  // HWY_ONCE
