// k-minimality for every mesh. The thesis guarantees it on planes (Theorems 1-7), but not where triangles meet (section
// 4.1, figure 4.3). A set of voxels is k-separating iff it is a vertex cover of the crossed links, and a cover can be
// thinned:
//
// For each of the eight parity classes in ascending order, remove every voxel of the class whose crossed links all have
// their other end in the set. No two voxels of a class are neighbors, so the order within a class does not matter. A
// voxel that its pass keeps has a crossed link with its other end outside. It stays essential, because the set only
// shrinks. So after eight passes the set is k-minimal, and still covers every link.
//
// Only voxels that are redundant before the first pass can ever be removed, the doubtful ones. They are few (about 1 %
// on smooth surfaces). Other voxels stay. So only the crossed links between two doubtful voxels decide.
#ifndef LATVOX_CORE_THIN_THIN_H_
#define LATVOX_CORE_THIN_THIN_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/stop_signal.h"
#include "core/brick/brick.h"
#include "core/thin/crossed_links.h"
#include "core/tile/tile_bits.h"

namespace latvox {

// Thins `set` in place and returns true, if that can be decided for all voxels in `wanted`; otherwise leaves it as it
// was. It can always be decided if `known` exceeds `wanted` by kThinHalo steps, because a voxel's fate depends only on
// voxels at most eight steps away.
//   doubtful  the members for which all crossed links with them as the nearer end are known, and all of these links
//             have their other end inside; each once, in any order
//   doubted   these, and other voxels that may be doubtful; all others stay, or do not matter to `wanted` (MayMatter)
//   links     all crossed links between two doubtful voxels; within `known`, also those between a doubtful voxel and
//             one that may be doubtful; others do no harm. Marks of doubtful voxels are set
//   known     local voxels; doubtful ones outside may have further links
//   wanted    local voxels, within `known`; `doubtful` has all of these that may be doubtful
// Once cancelled, it returns true soon, with a meaningless set.
bool Thin(const BitsLayout& layout, std::span<const uint32_t> doubtful, const TileBits& doubted, CrossedLinks& links,
          const IndexBox& known, const IndexBox& wanted, TileBits& set, StopSignal stop = {});

// See Thin.
inline constexpr int32_t kThinHalo = kParityClasses;

// Returns whether the fate of a voxel may affect voxels in `wanted`; others need not be doubted. A voxel's fate depends
// on neighbors of lower classes, because only these may have left before its pass. So a chain from a voxel so many
// steps outside of `wanted` climbs at least as many classes. That rules out half of a halo of eight steps.
//   reach   per axis, the longest step
inline bool MayMatter(const Vec3i& ijk, const IndexBox& wanted, const Vec3i& reach) {
  int32_t steps = 0;
  for (size_t m = 0; m < 3; ++m) {
    const int32_t outside = std::max(wanted.min[m] - ijk[m], ijk[m] - wanted.max[m] + 1);
    if (outside > 0) steps = std::max(steps, (outside + reach[m] - 1) / reach[m]);
  }
  return static_cast<int32_t>(BitsLayout::ParityClass(ijk)) + steps < kParityClasses;
}

}  // namespace latvox

#endif  // LATVOX_CORE_THIN_THIN_H_
