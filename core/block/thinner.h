// Removes the redundant voxels of a scanned surface.
#ifndef LATVOX_CORE_BLOCK_THINNER_H_
#define LATVOX_CORE_BLOCK_THINNER_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/block/star_batches.h"
#include "core/block/surface_scan.h"
#include "core/block/tile_context.h"
#include "core/scan/candidates.h"
#include "core/thin/crossed_links.h"
#include "core/tile/tile_bits.h"
#include "core/tile/tile_links.h"

namespace latvox {

// Finds the input of core/thin/thin.h: the voxels that may be redundant, and the links between them. It starts with the
// undecided voxels: all members of the surface that no link at hand shows essential. Then it asks the triangles at
// these voxels, and only there, for all their links.
//
// The result is exact, because a link only ever shows a voxel essential. A voxel leaves the undecided ones only for a
// known link with its farther end outside of the surface. The others keep all their links, and Thin decides on them.
// Where many voxels are undecided, they are asked when their pass comes. By then, neighbors that left have shown many
// of them essential. It reuses the memory of one node for the next.
class Thinner {
 public:
  // Removes redundant voxels; returns whether that was decided for the whole node. See Thin.
  bool Thin(const TileContext& context, const ScannedSurface& scanned);

  // Bytes of memory.
  size_t Bytes() const;

 private:
  bool Decide(const TileContext& context, const ScannedSurface& scanned);
  bool Pass(const TileContext& context, const ScannedSurface& scanned, const IndexBox& known);
  void FindUndecided(const TileContext& context, const ScannedSurface& scanned);
  void FindInnerAndEssential(const TileContext& context, const ScannedSurface& scanned);
  void AddInner(const Crossings& some, const TileBits& bits, bool in_set);
  void Ask(const TileContext& context, const ScannedSurface& scanned);
  void AskCandidates(const TileContext& context, BlockVoxels& voxels, const Candidates& candidates);
  bool FindPairsByBoxes(const BlockBox& where, const Candidates& candidates);
  void AskInTime(const TileContext& context, BlockVoxels& voxels);
  void AskPairs(const TileContext& context, BlockVoxels& voxels, std::span<const VoxelTriangle> pairs);
  void UpdateList();
  void FindInUndecided(const NumberList& voxels);
  void AddBorder(const TileContext& context, BlockVoxels& voxels, std::span<const uint32_t> members);

  TileBits undecided_{0};       // members of the surface that nothing has shown essential yet; empty between nodes
  std::vector<uint32_t> list_;  // all of undecided_, each once, and former members
  TileBits essential_{0};       // voxels that links of tiny triangles have shown essential; empty between nodes
  Crossings inside_;            // links of tiny triangles with both ends in the surface
  NumberList outward_;          // the nearer ends of other links
  Crossings inner_;             // links of tiny triangles, from voxels that are undecided or may become so
  PairMemory memory_;           // borrowed from the scan during Thin
  CrossedLinks links_;          // from members of undecided_
  bool in_passes_ = false;      // whether pairs wait for the passes of their voxels
  std::array<std::vector<VoxelTriangle>, kParityClasses> waiting_;  // by the parity classes of their voxels
};

}  // namespace latvox

#endif  // LATVOX_CORE_BLOCK_THINNER_H_
