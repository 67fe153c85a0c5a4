// The walls of a walk in a block of tiles: the surface, and what lies too near to the mesh.
#ifndef LATVOX_CORE_WALK_WALLS_H_
#define LATVOX_CORE_WALK_WALLS_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/band/triangle_distance.h"
#include "core/base/bytes_of.h"
#include "core/block/tile_context.h"
#include "core/block/tile_job.h"
#include "core/tile/tile_bits.h"
#include "core/tree/tile_tree.h"
#include "core/walk/plan.h"
#include "core/walk/tile_rows.h"

namespace latvox {

// Each thread has its own, and reuses it from block to block.
class WallScan {
 public:
  // Finds the walls in the node and its overlap.
  //   node    of a tree with margins that include those of `close`
  //   close   null, or what also makes a wall near the mesh
  void Scan(const TileContext& context, const BandPlan* close, const TileNode& node);

  // Whether a box may have walls.
  bool MayMeet(const HaloBox& box) const;

  // The rows of the surface, and of all walls, in a box within the node and its overlap.
  void SurfaceIn(const HaloBox& box, std::vector<WideRow>& rows);
  void WallsIn(const HaloBox& box, std::vector<WideRow>& rows);

  size_t Bytes() const { return block_.Bytes() + near_.Bytes() + BytesOf(near_rows_); }

 private:
  void AddNear(const TileContext& context, const BandPlan& close, std::span<const uint32_t> triangles);

  BlockScan block_;
  bool has_near_ = false;
  TileBits near_{0};  // in the layout of the surface's voxels
  std::vector<WideRow> near_rows_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_WALK_WALLS_H_
