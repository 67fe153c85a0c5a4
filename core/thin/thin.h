// k-minimality for every mesh: the thesis guarantees it on planes (Theorems 1-7), not where triangles meet
// (section 4.1, figure 4.3). A set of voxels is k-separating iff it is a vertex cover of the crossed edges; a cover can
// be thinned:
//
// For each of the eight parity classes in ascending order, remove every voxel of the class whose crossed edges all have
// their other end in the set. No two voxels of a class are neighbors, so the order within a class does not matter.
// What a pass keeps has a crossed edge with its other end outside, and stays essential since the set only shrinks:
// after eight passes the set is k-minimal, and still covers every edge.
//
// Only voxels that are redundant before the first pass can ever be removed, the doubtful ones; they are few (about 1 %
// on smooth surfaces). What is not doubtful stays: so of all crossed edges, those between two doubtful voxels alone
// decide.
#ifndef LATVOX_CORE_THIN_THIN_H_
#define LATVOX_CORE_THIN_THIN_H_

#include <cstdint>
#include <span>

#include "core/base/stop_signal.h"
#include "core/brick/brick.h"
#include "core/thin/crossed_links.h"
#include "core/tile/tile_bits.h"

namespace latvox {

// Thins `set` in place and returns true, if that can be decided for all voxels in `wanted`; else leaves it as it was.
// It always can if what is known exceeds `wanted` by kThinHalo steps: a voxel's fate depends on others at most eight
// steps away.
//   doubtful  the members all of whose crossed links from this end, as the nearer one, are known, and none of them
//             shows essential by its other end being outside; each once, in any order
//   doubted   these, and what else may be doubtful: what is not there stays
//   links     all crossed links between two doubtful voxels; within `known`, also those between one and what else may
//             be doubtful; others do no harm. Marks of doubtful voxels are set
//   known     local voxels; beyond, doubtful ones may have further links
//   wanted    local voxels, within `known`; there, what may be doubtful is in `doubtful`
// Once cancelled, it returns true soon, and the set means nothing.
bool Thin(const BitsLayout& layout, std::span<const uint32_t> doubtful, const TileBits& doubted, CrossedLinks& links,
          const IndexBox& known, const IndexBox& wanted, TileBits& set, StopSignal stop = {});

// See Thin.
inline constexpr int32_t kThinHalo = kParityClasses;

}  // namespace latvox

#endif  // LATVOX_CORE_THIN_THIN_H_
