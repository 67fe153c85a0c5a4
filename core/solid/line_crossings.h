// All crossings of a mesh with lattice lines along k, in order.
#ifndef LATVOX_CORE_SOLID_LINE_CROSSINGS_H_
#define LATVOX_CORE_SOLID_LINE_CROSSINGS_H_

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "core/base/stop_signal.h"
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

// Joins the parts, ascending. It works by slabs, so it ends soon once cancelled, with a meaningless result.
template <class Crossing>
std::vector<Crossing> SortedLineCrossings(std::vector<std::vector<Crossing>>&& parts, StopSignal stop) {
  // The place of each slab's next crossing; at the end, the slab's end.
  std::vector<size_t> next(LineCrossing::kSlabs + 1);
  for (const auto& part : parts) {
    for (const Crossing& crossing : part) ++next[LineCrossing::Slab(PlaceOf(crossing)) + 1];
  }
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<Crossing> all(next.back());
  for (auto& part : parts) {
    if (stop.Stopped()) return all;
    for (const Crossing& crossing : part) all[next[LineCrossing::Slab(PlaceOf(crossing))]++] = crossing;
    part = std::vector<Crossing>();  // {} would keep its memory
  }
  oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<size_t>(0, LineCrossing::kSlabs), [&](const auto& slabs) {
    for (size_t n = slabs.begin(); n < slabs.end() && !stop.Stopped(); ++n) {
      std::sort(all.data() + (n == 0 ? 0 : next[n - 1]), all.data() + next[n]);
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
  std::vector<std::vector<Crossing>> parts((count + kChunk - 1) / kChunk);
  oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<size_t>(0, parts.size()), [&](const auto& numbers) {
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
                                           parts[n].push_back(make(t, LineCrossing::Make(i, line_j, above, turn)));
                                         });
        }
      }
    }
  });
  return SortedLineCrossings(std::move(parts), stop);
}

template <int kUnitBits>
std::vector<uint64_t> FindLineCrossings(const SnappedMesh& mesh, const IndexBox& region, StopSignal stop) {
  return FindLineCrossings<kUnitBits>(mesh, region, stop, [](size_t, uint64_t place) { return place; });
}

}  // namespace latvox

#endif  // LATVOX_CORE_SOLID_LINE_CROSSINGS_H_
