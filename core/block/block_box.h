// The box of a block's scan, and the numbers of its voxels.
#ifndef LATVOX_CORE_BLOCK_BLOCK_BOX_H_
#define LATVOX_CORE_BLOCK_BLOCK_BOX_H_

#include <hwy/base.h>

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/block/tile_context.h"
#include "core/brick/brick.h"
#include "core/scan/stars.h"
#include "core/tile/tile_bits.h"
#include "core/tile/tile_links.h"
#include "core/tree/tile_tree.h"

namespace latvox {

struct BlockBox {
  IndexBox block{}, wanted{}, box{};  // the node's voxels; with the context's overlap; also with the halo
  BitsLayout layout{{}, {}};
  std::array<int32_t, kMaxDirections> steps{};  // of layout, along the frames

  BlockBox() = default;
  // The box of `halo` steps around the node and its overlap.
  BlockBox(const TileContext& context, const TileNode& node, int32_t halo) {
    const Vec3i low = node.tile_ijk * kTileSide;
    const int32_t side = kTileSide << node.level;
    block = {low, low + Vec3i{side, side, side}};
    wanted = {block.min - context.overlap, block.max + context.overlap};
    box = {wanted.min - context.reach * halo, wanted.max + context.reach * halo};
    layout = BitsLayout(low, context.overlap + context.reach * (halo + 1), side);
    for (size_t n = 0; n < context.frames.size(); ++n) steps[n] = layout.StepOf(context.frames[n].frame.q);
  }

  // Returns the box without so many voxels, per axis, on every side.
  IndexBox Shrunk(const Vec3i& by) const { return {box.min + by, box.max - by}; }

  // Returns the farther end of the link along direction n of a voxel's star.
  HWY_INLINE uint32_t EndOf(uint32_t voxel, const StarLinks& star, size_t n) const {
    return voxel + static_cast<uint32_t>((star.forward >> n & 1) != 0 ? steps[n] : -steps[n]);
  }

  // Calls f(crossings), batch by batch, with all links of tiny triangles from voxels of the box.
  template <class F>
  void ForEachTinyBatch(const TileContext& context, F&& f) const {
    if (context.links.empty()) return;
    std::array<int32_t, kPackedDirections> packed{};
    for (size_t n = 0; n < kMaxPairs; ++n) {
      packed[2 * n] = -steps[n];
      packed[2 * n + 1] = steps[n];
    }
    context.links.ForEachBatch(block, box, layout, packed, f);
  }
};

}  // namespace latvox

#endif  // LATVOX_CORE_BLOCK_BLOCK_BOX_H_
