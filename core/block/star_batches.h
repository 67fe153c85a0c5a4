// Pairs of a voxel and a triangle that is asked for the links that it crosses there.
#ifndef LATVOX_CORE_BLOCK_STAR_BATCHES_H_
#define LATVOX_CORE_BLOCK_STAR_BATCHES_H_

#include <hwy/base.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/bytes_of.h"
#include "core/base/stop_signal.h"
#include "core/block/tile_context.h"
#include "core/scan/candidates.h"
#include "core/scan/stars.h"
#include "core/tile/tile_bits.h"

namespace latvox {

// Memory that a scan and its thinner use in turn. With memory for each, a job of 8 ms without pages of earlier jobs
// took 1 ms more.
struct PairMemory {
  NumberList positions;  // in a list of candidates
  std::vector<VoxelTriangle> pairs;

  size_t Bytes() const { return positions.Bytes() + BytesOf(pairs); }
};

// Calls f(numbers) for pieces of a list, which may have millions of numbers, until it is stopped.
template <class F>
void ForEachPiece(const NumberList& list, StopSignal stop, F&& f) {
  constexpr size_t kPiece = size_t{1} << 14;  // numbers between two looks at the stop signal
  const std::span<const uint32_t> numbers = list.view();
  for (size_t first = 0; first < numbers.size() && !stop.Stopped(); first += kPiece) {
    f(numbers.subspan(first, std::min(kPiece, numbers.size() - first)));
  }
}

// Replaces `pairs` by the voxels at `positions` of one of the candidates' lists, each with the triangle that put it
// there.
//   end   the member of Candidates::Run for that list
//   stop  once stopped, some pairs are missing
inline void FindPairs(const Candidates& candidates, const NumberList& voxels, const NumberList& positions,
                      uint32_t Candidates::Run::*end, StopSignal stop, std::vector<VoxelTriangle>& pairs) {
  pairs.clear();
  auto next = candidates.runs.begin();
  ForEachPiece(positions, stop, [&](std::span<const uint32_t> piece) {
    auto run = next;  // a copy, which stays in a register
    for (const uint32_t n : piece) {
      while ((*run).*end <= n) ++run;
      pairs.push_back({voxels[n] & kNumberMask, candidates.TriangleAt(*run, voxels[n] >> kNumberBits)});
    }
    next = run;
  });
}

// Calls f(voxel, star) for all pairs with wanted(voxel) when the pair's turn comes. It is inlined: as
// a function of its own, it cost 3 % of all instructions where large triangles meet.
template <class Wanted, class F>
HWY_INLINE void ForEachStar(const TileContext& context, const BitsLayout& layout, std::span<const VoxelTriangle> pairs,
                            Wanted&& wanted, F&& f) {
  constexpr size_t kBatch = 64;  // what f finds spares work in later batches
  StarLinks stars[kBatch];
  VoxelTriangle batch[kBatch];
  for (size_t n = 0; n < pairs.size() && !context.stop.Stopped();) {
    size_t size = 0;
    for (; n < pairs.size() && size < kBatch; ++n) {
      batch[size] = pairs[n];
      size += wanted(pairs[n].voxel) ? 1 : 0;
    }
    FindStarLinks(context.mesh, context.frames, layout, {batch, size}, stars);
    for (size_t m = 0; m < size; ++m) f(batch[m].voxel, stars[m]);
  }
}

}  // namespace latvox

#endif  // LATVOX_CORE_BLOCK_STAR_BATCHES_H_
