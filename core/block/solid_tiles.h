// The interior points of tiles, alone or with the surface's voxels.
#ifndef LATVOX_CORE_BLOCK_SOLID_TILES_H_
#define LATVOX_CORE_BLOCK_SOLID_TILES_H_

#include <cstdint>
#include <memory>
#include <span>
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
#include "core/solid/labels.h"
#include "core/tile/tile_bits.h"
#include "core/tree/tile_tree.h"

namespace latvox {

// Returns the interior of a solid, the rule for it (that of `solid`, or what kAuto becomes), and the number of the
// mesh's lines along k that end unbalanced.
//   has_fraction   whether voxels carry fractions, which no mesh that is not closed has
//   closed         from the mesh's SurfaceFacts
//   region         local voxels for which the interior is needed
// Errors: INVALID_ARGUMENT if the mesh has no inside and solid.force_open is not set; CANCELLED.
absl::StatusOr<std::unique_ptr<const Interior>> MakeInterior(const SnappedMesh& mesh, const Solid& solid,
                                                             bool has_fraction, bool closed, const IndexBox& region,
                                                             StopSignal stop, InteriorRule& rule,
                                                             uint64_t& unbalanced_lines);

// The same for a labeled solid. It sums up the unbalanced lines of all labels.
// Errors: INVALID_ARGUMENT, naming the first label that has no inside, unless solid.force_open is set; CANCELLED.
absl::StatusOr<std::unique_ptr<const Interior>> MakeLabeledInterior(const SnappedMesh& mesh, const Labels& labels,
                                                                    const Solid& solid, bool has_fraction,
                                                                    const IndexBox& region, StopSignal stop,
                                                                    InteriorRule& rule, uint64_t& unbalanced_lines);

// Returns whether the frames include those along the three axes of lattice coordinates. Then a triangle that touches no
// line along the frames does not matter to the interior, either.
bool HasAxes(const std::vector<Frame>& frames);

// The tiles of a node, one after the other. It reuses the memory of one node for the next.
class SolidTiles {
 public:
  SolidTiles();

  // Begins a node.
  void Sort(const SnappedMesh& mesh, const TileNode& node, StopSignal stop);

  // Returns the rows of the interior of the node's tile with that number in Morton order, valid until the next call.
  std::span<const uint64_t> RowsOf(const Interior& interior, size_t number, const Vec3i& tile_ijk) {
    interior.Find(tile_ijk, triangles_[number], rows_);
    return rows_.view();
  }

  // Returns the bricks of the node's tile with that number in Morton order, like BlockVoxels::CutOut.
  //   tile_ijk   its position, local
  //   surface    null, or the voxels of the node's surface, to which the interior is added
  TileBricks CutOut(const TileContext& context, const Interior& interior, size_t number, const Vec3i& tile_ijk,
                    BlockVoxels* surface);

  // Bytes of memory.
  size_t Bytes() const;

 private:
  std::vector<uint32_t> crossing_;                // of the node's triangles
  std::vector<std::vector<uint32_t>> triangles_;  // of each tile
  InteriorRows rows_;
  TileBits bits_;  // for a tile alone
};

}  // namespace latvox

#endif  // LATVOX_CORE_BLOCK_SOLID_TILES_H_
