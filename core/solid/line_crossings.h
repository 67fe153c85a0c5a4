// All crossings of a mesh with lattice lines along k, in order.
#ifndef LATVOX_CORE_SOLID_LINE_CROSSINGS_H_
#define LATVOX_CORE_SOLID_LINE_CROSSINGS_H_

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include <atomic>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/snap/snap.h"
#include "core/solid/axis_crossing.h"

namespace latvox {

// One crossing as a number: the line's i and j, the lowest point above the crossing, and its sense; crossings of a line
// ascend with these numbers. Coordinates are local, in steps of the lines' lattice; they may be a little below 0.
class LineCrossing {
 public:
  // No crossing above which `above` is lower is less.
  static uint64_t Least(int32_t i, int32_t j, int32_t above) {
    return Field(i) << (2 * kBits + 1) | Field(j) << (kBits + 1) | Field(above) << 1;
  }
  static uint64_t Make(int32_t i, int32_t j, int32_t above, int32_t turn) {
    return Least(i, j, above) | (turn > 0 ? 1 : 0);
  }
  static int32_t LineJ(uint64_t crossing) { return Coordinate(crossing >> (kBits + 1)); }
  static int32_t Above(uint64_t crossing) { return Coordinate(crossing >> 1); }
  static int32_t Turn(uint64_t crossing) { return (crossing & 1) != 0 ? 1 : -1; }

 private:
  static constexpr int kBits = 21;
  static constexpr int32_t kOffset = 1 << (kBits - 2);
  static_assert(kMaxExtent + 2 * kTileSide < kOffset && 3 * kBits + 1 <= 64);

  static uint64_t Field(int32_t coordinate) { return static_cast<uint64_t>(coordinate + kOffset); }
  static int32_t Coordinate(uint64_t field) {
    return static_cast<int32_t>(field & ((uint64_t{1} << kBits) - 1)) - kOffset;
  }
};

// Those with the lines whose coordinates are multiples of 2^kUnitBits lattice units, ascending.
template <int kUnitBits>
std::vector<uint64_t> FindLineCrossings(const SnappedMesh& mesh, const std::atomic<bool>& cancelled) {
  constexpr size_t kChunk = 1 << 14;  // triangles a task
  constexpr int64_t kAll = std::numeric_limits<int32_t>::max();
  const size_t count = mesh.triangles.size();
  std::vector<std::vector<uint64_t>> parts((count + kChunk - 1) / kChunk);
  oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<size_t>(0, parts.size()), [&](const auto& numbers) {
    for (size_t n = numbers.begin(); n < numbers.end(); ++n) {
      for (size_t t = n * kChunk; t < std::min(count, (n + 1) * kChunk) && !cancelled; ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        ForEachAxisCrossing<kUnitBits>({mesh.vertices_lat[a], mesh.vertices_lat[b], mesh.vertices_lat[c]}, 2,
                                       {{-kAll, kAll}, {-kAll, kAll}},
                                       [&](int32_t i, int32_t j, int32_t above, int32_t turn) {
                                         parts[n].push_back(LineCrossing::Make(i, j, above, turn));
                                       });
      }
    }
  });
  size_t size = 0;
  for (const auto& part : parts) size += part.size();
  std::vector<uint64_t> all;
  all.reserve(size);
  for (auto& part : parts) {
    all.insert(all.end(), part.begin(), part.end());
    part = {};
  }
  oneapi::tbb::parallel_sort(all.begin(), all.end());
  return all;
}

}  // namespace latvox

#endif  // LATVOX_CORE_SOLID_LINE_CROSSINGS_H_
