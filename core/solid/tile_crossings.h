// The crossings that decide on the lattice points of a tile.
#ifndef LATVOX_CORE_SOLID_TILE_CROSSINGS_H_
#define LATVOX_CORE_SOLID_TILE_CROSSINGS_H_

#include <cstddef>
#include <cstdint>

#include "core/base/vec.h"
#include "core/brick/brick.h"
#include "core/snap/snap.h"
#include "core/solid/axis_crossing.h"

namespace latvox {

// Corners of tiles are the points of a lattice of their own.
inline constexpr int kCornerBits = kSubvoxelBits + kTileBits;

// Calls a function for each of the triangle's crossings with some lines of the tile. It gets the lowest point above the
// crossing, which is never the line's first, and the change of the sum there:
//   along_i(i, turn)             on the line (i, 0, 0)
//   along_j(i, j, turn)          on the lines (i, j, 0)
//   along_k(i << 6 | j, k, turn) on all lines along k
// `low` is the tile's lowest point.
template <class AlongI, class AlongJ, class AlongK>
void ForEachTileCrossing(const Triangle& triangle, const Vec3i& low, const AlongI& along_i, const AlongJ& along_j,
                         const AlongK& along_k) {
  const auto lines = [&](size_t a, bool all_a, size_t b, bool all_b) {
    const int64_t last = kTileSide - 1;
    return AxisLines{{low[a], low[a] + (all_a ? last : 0)}, {low[b], low[b] + (all_b ? last : 0)}};
  };
  const auto is_within = [](int32_t step) { return step > 0 && step < kTileSide; };
  ForEachAxisCrossing<kSubvoxelBits>(triangle, 0, lines(1, false, 2, false),
                                     [&](int32_t, int32_t, int32_t above, int32_t turn) {
                                       const int32_t i = above - low[0];
                                       if (is_within(i)) along_i(static_cast<size_t>(i), turn);
                                     });
  ForEachAxisCrossing<kSubvoxelBits>(triangle, 1, lines(2, false, 0, true),
                                     [&](int32_t, int32_t i, int32_t above, int32_t turn) {
                                       const int32_t j = above - low[1];
                                       if (is_within(j)) along_j(static_cast<size_t>(i - low[0]), j, turn);
                                     });
  ForEachAxisCrossing<kSubvoxelBits>(triangle, 2, lines(0, true, 1, true),
                                     [&](int32_t i, int32_t j, int32_t above, int32_t turn) {
                                       const int32_t k = above - low[2];
                                       if (is_within(k))
                                         along_k(static_cast<size_t>((i - low[0]) * kTileSide + j - low[1]), k, turn);
                                     });
}

}  // namespace latvox

#endif  // LATVOX_CORE_SOLID_TILE_CROSSINGS_H_
