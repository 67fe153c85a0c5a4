// The interior points of tiles, alone or with the surface's voxels.
#ifndef LATVOX_CORE_BLOCK_SOLID_TILES_H_
#define LATVOX_CORE_BLOCK_SOLID_TILES_H_

#include <cstdint>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/stop_signal.h"
#include "core/block/block_voxels.h"
#include "core/block/tile_context.h"
#include "core/brick/brick.h"
#include "core/lattice/frame.h"
#include "core/request/solid.h"
#include "core/snap/snap.h"
#include "core/solid/interior.h"
#include "core/tile/tile_bits.h"
#include "core/tree/tile_tree.h"

namespace latvox {

// The interior of a solid, and how many of the mesh's lines along k end unbalanced.
//   closed   of the mesh, by SurfaceFacts
//   region   local voxels, of which the interior is wanted
// Errors: INVALID_ARGUMENT if the mesh has no inside and solid.force_open is not set; CANCELLED.
absl::StatusOr<std::unique_ptr<const Interior>> MakeInterior(const SnappedMesh& mesh, const Solid& solid, bool closed,
                                                             const IndexBox& region, StopSignal stop,
                                                             uint64_t& unbalanced_lines);

// Whether the frames include those along the three axes of lattice coordinates: then triangles that touch no line along
// the frames are nothing to the interior, either.
bool HasAxes(const std::vector<Frame>& frames);

// The tiles of a node, one after the other. What a thread allocates for one node serves it for the next.
class SolidTiles {
 public:
  SolidTiles();

  // Begins a node.
  void Sort(const SnappedMesh& mesh, const TileNode& node, StopSignal stop);

  // The bricks of the node's tile of that number, in Morton order, as BlockVoxels::CutOut has them.
  //   tile_ijk   where it is, local
  //   surface    null, or those of the node's surface, which the interior is added to
  TileBricks CutOut(const TileContext& context, const Interior& interior, size_t number, const Vec3i& tile_ijk,
                    BlockVoxels* surface);

  // Of memory.
  size_t Bytes() const;

 private:
  std::vector<std::vector<uint32_t>> triangles_;  // of each tile
  InteriorRows rows_;
  TileBits bits_;  // of a tile alone
};

}  // namespace latvox

#endif  // LATVOX_CORE_BLOCK_SOLID_TILES_H_
