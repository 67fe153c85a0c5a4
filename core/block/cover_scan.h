// The supercover's voxels in a box, from the triangles around it.
#ifndef LATVOX_CORE_BLOCK_COVER_SCAN_H_
#define LATVOX_CORE_BLOCK_COVER_SCAN_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/bytes_of.h"
#include "core/block/block_voxels.h"
#include "core/block/candidate_parts.h"
#include "core/block/star_batches.h"
#include "core/block/tile_context.h"

namespace latvox {

// The set is exact, because it is a union over triangles. Where cells are boxes, triangles go one of three ways, which
// all end with the same voxels (core/supercover/box_cells.h):
// - A small one covers the voxels of its corners, and those of its box whose cells meet it.
// - Most others are scanned as for k = 0, and the cells of their rims are tested.
// - A few touch cells exactly. They go row by row.
// A voxel that is a member already is not tested, which does not change the union. On smooth surfaces most are. In fine
// meshes, core/tiny/tiny_cover.h has found the voxels of tiny triangles before, and the others come here.
//
// On most other lattices, most triangles are scanned, and the cells at their rims and beyond their planes are tested
// (core/supercover/near_cells.h). The others go row by row.
//
// Reuses the memory of one node for the next.
class CoverScan {
 public:
  // Adds the supercover of the triangles in voxels.where().box. Leaves part of it out once the job is cancelled.
  //   triangles   must live until the node is done
  void Add(const TileContext& context, std::span<const uint32_t> triangles, CandidateParts& candidates,
           PairMemory& memory, BlockVoxels& voxels);

  // Bytes of memory.
  size_t Bytes() const {
    return BytesOf(scanned_) + BytesOf(open_) + BytesOf(batch_) + lines_.Bytes() + BytesOf(left_);
  }

 private:
  void AddBoxes(const TileContext& context, std::span<const uint32_t> triangles, CandidateParts& candidates,
                PairMemory& memory, BlockVoxels& voxels);
  void AddNearCells(const TileContext& context, std::span<const uint32_t> triangles, PairMemory& memory,
                    BlockVoxels& voxels);
  void AddSmall(uint32_t t, const IndexBox& cells, const Triangle& triangle, BlockVoxels& voxels);
  void AddRows(const TileContext& context, const Triangle& triangle, BlockVoxels& voxels);
  template <class Keep>
  void AddMeeting(const TileContext& context, std::span<const VoxelTriangle> pairs, const Keep& keep,
                  BlockVoxels& voxels);

  std::vector<uint32_t> scanned_;     // triangles
  std::vector<VoxelTriangle> open_;   // of small triangles, still to be tested
  std::vector<VoxelTriangle> batch_;  // of AddMeeting
  Candidates lines_;                  // of AddNearCells
  std::vector<uint32_t> left_;        // triangles without them
  NumberRange covered_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_BLOCK_COVER_SCAN_H_
