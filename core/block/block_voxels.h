// The set of voxels of one block of tiles.
#ifndef LATVOX_CORE_BLOCK_BLOCK_VOXELS_H_
#define LATVOX_CORE_BLOCK_BLOCK_VOXELS_H_

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/block/block_box.h"
#include "core/block/tile_context.h"
#include "core/brick/brick.h"
#include "core/tile/tile_bits.h"

namespace latvox {

// Where few voxels lie in a large block, most of the time would go into clearing and cutting out all of it. So a caller
// that sets bits marks them dirty, and only dirty parts are cleared and cut out.
class BlockVoxels {
 public:
  // Makes it empty, for the voxels of this box.
  void Reset(const BlockBox& where);

  const BlockBox& where() const { return where_; }
  const TileBits& bits() const { return bits_; }
  TileBits& bits() { return bits_; }
  // Contain all members since Reset.
  const NumberRange& dirty() const { return dirty_; }
  const IndexBox& dirty_box() const { return dirty_box_; }

  // Adds voxels, by the low kNumberBits of their numbers.
  void Add(std::span<const uint32_t> voxels) {
    MarkDirty(voxels);
    bits_.SetAll(voxels);
  }
  // Marks voxels that are set or will be: each voxel, or all planes (along i) from the first to the last.
  void MarkDirty(std::span<const uint32_t> voxels);
  void MarkPlanesDirty(const NumberRange& voxels);

  // Adds the voxels of a tile (local) of the block: bit k of rows[i << 6 | j].
  void AddRows(const Vec3i& tile_ijk, std::span<const uint64_t> rows);

  // Returns the bricks of a tile (local) of the block in lexicographic order, in global coordinates, without voxels
  // outside of context.region.
  TileBricks CutOut(const TileContext& context, const Vec3i& tile_ijk) const;

  // Bytes of memory.
  size_t Bytes() const { return bits_.Bytes(); }

 private:
  BlockBox where_;
  TileBits bits_{0};
  NumberRange dirty_;
  IndexBox dirty_box_{};
};

}  // namespace latvox

#endif  // LATVOX_CORE_BLOCK_BLOCK_VOXELS_H_
