// All crossings of a mesh with lattice lines along k, in order.
#ifndef LATVOX_CORE_SOLID_LINE_CROSSINGS_H_
#define LATVOX_CORE_SOLID_LINE_CROSSINGS_H_

#include <oneapi/tbb/blocked_range.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "core/base/metered.h"
#include "core/base/sort.h"
#include "core/base/stop_signal.h"
#include "core/base/uninitialized.h"
#include "core/snap/snap.h"
#include "core/solid/axis_crossing.h"

namespace latvox {

// One crossing as a number: the line's i and j, the lowest point above the crossing, and its sense. The crossings of a
// line ascend with these numbers. Coordinates are local, in steps of the lines' lattice; they may be a little below 0.
class LineCrossing {
  static constexpr int kBits = 21, kSlabShift = 2 * kBits + 1 + 6;
  static constexpr int32_t kOffset = 1 << (kBits - 2), kFarthest = kMaxExtent + 2 * kTileSide;
  static_assert(kFarthest < kOffset && 3 * kBits + 1 <= 64);
  static constexpr size_t kFirstSlab = static_cast<size_t>(kOffset - kFarthest) >> 6;

 public:
  // No crossing with a lower `above` is less.
  static uint64_t Least(int32_t i, int32_t j, int32_t above) {
    return Field(i) << (2 * kBits + 1) | Field(j) << (kBits + 1) | Field(above) << 1;
  }
  static uint64_t Make(int32_t i, int32_t j, int32_t above, int32_t turn) {
    return Least(i, j, above) | (turn > 0 ? 1 : 0);
  }
  static int32_t LineJ(uint64_t crossing) { return Coordinate(crossing >> (kBits + 1)); }
  static int32_t Above(uint64_t crossing) { return Coordinate(crossing >> 1); }
  static int32_t Turn(uint64_t crossing) { return (crossing & 1) != 0 ? 1 : -1; }

  static bool AreOnOneLine(uint64_t a, uint64_t b) { return a >> (kBits + 1) == b >> (kBits + 1); }

  // The slab of 64 consecutive i that it lies in.
  static size_t Slab(uint64_t crossing) { return static_cast<size_t>(crossing >> kSlabShift) - kFirstSlab; }
  static constexpr size_t kSlabs = (static_cast<size_t>(kOffset + kFarthest) >> 6) - kFirstSlab + 1;

 private:
  static uint64_t Field(int32_t coordinate) { return static_cast<uint64_t>(coordinate + kOffset); }
  static int32_t Coordinate(uint64_t field) {
    return static_cast<int32_t>(field & ((uint64_t{1} << kBits) - 1)) - kOffset;
  }
};

// The same, with the label of the triangle.
struct LabeledCrossing {
  uint64_t place;  // as LineCrossing makes it
  uint32_t rank;   // of the label, see core/solid/labels.h
  bool operator<(const LabeledCrossing& other) const { return place < other.place; }
};

inline uint64_t PlaceOf(uint64_t crossing) { return crossing; }
inline uint64_t PlaceOf(const LabeledCrossing& crossing) { return crossing.place; }

// The number of crossings grows with the square of the resolution, so arrays of them begin without zeros.
template <class Crossing>
using LineCrossings = UninitializedVector<Crossing>;

// Crossings in the order of their discovery, in pieces: a large array would be copied, and freed, at once.
template <class Crossing>
class CrossingList {
 public:
  void Add(const Crossing& crossing) {
    if (pieces_.empty() || pieces_.back().size() == kSortedPiece) pieces_.emplace_back();
    pieces_.back().push_back(crossing);
  }
  // Calls f with each of them, in order. Ends soon once cancelled.
  template <class F>
  void ForEach(StopSignal stop, const F& f) const {
    for (const std::vector<Crossing>& piece : pieces_) {
      if (stop.Stopped()) return;
      for (const Crossing& crossing : piece) f(crossing);
    }
  }

 private:
  std::vector<std::vector<Crossing>> pieces_;
};

// Joins the parts, ascending. Ends soon once cancelled, with a meaningless result.
template <class Crossing>
LineCrossings<Crossing> SortedLineCrossings(std::vector<CrossingList<Crossing>>&& parts, StopSignal stop) {
  // The place of each slab's next crossing; at the end, the slab's end.
  std::vector<size_t> next(LineCrossing::kSlabs + 1);
  for (const auto& part : parts) {
    part.ForEach(stop, [&](const Crossing& c) { ++next[LineCrossing::Slab(PlaceOf(c)) + 1]; });
  }
  if (stop.Stopped()) return {};
  std::partial_sum(next.begin(), next.end(), next.begin());
  LineCrossings<Crossing> all(next.back());
  for (auto& part : parts) {
    part.ForEach(stop, [&](const Crossing& c) { all[next[LineCrossing::Slab(PlaceOf(c))]++] = c; });
    if (stop.Stopped()) return {};
    part = {};
  }
  MeteredFor(oneapi::tbb::blocked_range<size_t>(0, LineCrossing::kSlabs), [&](const auto& slabs) {
    for (size_t n = slabs.begin(); n < slabs.end() && !stop.Stopped(); ++n) {
      const size_t begin = n == 0 ? 0 : next[n - 1];
      Sort(std::span(all).subspan(begin, next[n] - begin), stop);
    }
  });
  return all;
}

// Returns the crossings with lines whose coordinates are multiples of 2^kUnitBits lattice units, ascending. Such a line
// is below or at each voxel (local) of the region on i and j. Ends soon once cancelled, with a meaningless result.
//   make   make(t, place) returns the crossing of triangle t: a LabeledCrossing or the place
template <int kUnitBits, class Make>
auto FindLineCrossings(const SnappedMesh& mesh, const IndexBox& region, StopSignal stop, const Make& make) {
  using Crossing = decltype(make(size_t{0}, uint64_t{0}));
  constexpr size_t kChunk = 1 << 14;  // triangles for each task
  constexpr int kVoxelBits = kUnitBits - kSubvoxelBits;
  const AxisLines lines{{region.min[0] >> kVoxelBits, (region.max[0] - 1) >> kVoxelBits},
                        {region.min[1] >> kVoxelBits, (region.max[1] - 1) >> kVoxelBits}};
  constexpr int32_t kRows = 64;  // of lines, between polls of the stop signal
  const size_t count = mesh.triangles.size();
  std::vector<CrossingList<Crossing>> parts((count + kChunk - 1) / kChunk);
  MeteredFor(oneapi::tbb::blocked_range<size_t>(0, parts.size()), [&](const auto& numbers) {
    for (size_t n = numbers.begin(); n < numbers.end(); ++n) {
      for (size_t t = n * kChunk; t < std::min(count, (n + 1) * kChunk); ++t) {
        const Triangle triangle = mesh.TriangleAt(t);
        const int32_t low = std::min(std::min(triangle[0][1], triangle[1][1]), triangle[2][1]);
        const int32_t high = std::max(std::max(triangle[0][1], triangle[1][1]), triangle[2][1]);
        const int64_t last = std::min(int64_t{high >> kUnitBits}, lines.b.last);
        const int64_t first = (int64_t{low} + (int64_t{1} << kUnitBits) - 1) >> kUnitBits;  // mostly beyond `last`
        for (int64_t j = std::max(first, lines.b.first); j <= last && !stop.Stopped(); j += kRows) {
          ForEachAxisCrossing<kUnitBits>(triangle, 2, {lines.a, {j, std::min(j + kRows - 1, last)}},
                                         [&](int32_t i, int32_t line_j, int32_t above, int32_t turn) {
                                           parts[n].Add(make(t, LineCrossing::Make(i, line_j, above, turn)));
                                         });
        }
      }
    }
  });
  return SortedLineCrossings(std::move(parts), stop);
}

template <int kUnitBits>
LineCrossings<uint64_t> FindLineCrossings(const SnappedMesh& mesh, const IndexBox& region, StopSignal stop) {
  return FindLineCrossings<kUnitBits>(mesh, region, stop, [](size_t, uint64_t place) { return place; });
}

}  // namespace latvox

#endif  // LATVOX_CORE_SOLID_LINE_CROSSINGS_H_
