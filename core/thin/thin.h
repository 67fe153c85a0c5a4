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
// on smooth surfaces), but two thirds of designed parts with thin walls. So the links of a voxel may wait until its
// pass. A voxel that leaves shows the other ends of its links essential, and their links need not be known at all. That
// is why only links from the nearer end are needed. A pass sees every link between two doubtful voxels from one end or
// the other:
//
// - The nearer end leaves first: it keeps the farther end.
// - The farther end leaves first: the nearer end, in its own pass, has a link that leads out of the set.
#ifndef LATVOX_CORE_THIN_THIN_H_
#define LATVOX_CORE_THIN_THIN_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "core/base/stop_signal.h"
#include "core/brick/brick.h"
#include "core/thin/crossed_links.h"
#include "core/tile/tile_bits.h"

namespace latvox {

// Thins `set` in place and returns true, if that can be decided for all voxels in `wanted`; otherwise leaves it as it
// was. It can always be decided if `known` exceeds `wanted` by kThinHalo steps, because a voxel's fate depends only on
// voxels at most eight steps away.
//   members  all voxels of `doubted`, each once, in any order; others do no harm
//   doubted  members of the set that may be doubtful. All others stay, or do not matter to `wanted` (MayMatter). Voxels
//            that prove essential leave it
//   links    crossed links with a member as the nearer end. Marks of members are set
//   ask      called with each parity class before its pass. Then adds all links of the doubted voxels of this class, or
//            removes those from `doubted` that have a link out of the set
//   known    local voxels; members outside may have further links, or doubtful neighbors that are no members
//   wanted   local voxels, within `known`
// Once cancelled, it returns true soon, with a meaningless set.
bool Thin(const BitsLayout& layout, std::span<const uint32_t> members, TileBits& doubted, CrossedLinks& links,
          const std::function<void(uint32_t parity)>& ask, const IndexBox& known, const IndexBox& wanted, TileBits& set,
          StopSignal stop = {});

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
