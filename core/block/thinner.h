// Removes the redundant voxels of a scanned surface.
#ifndef LATVOX_CORE_BLOCK_THINNER_H_
#define LATVOX_CORE_BLOCK_THINNER_H_

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

// Finds what core/thin/thin.h asks for: the voxels that may be redundant, and the links between them. It starts from
// all members of the surface that no link at hand shows essential, the undecided ones. It then asks the triangles at
// these voxels, and only there, for all their links. What a thread allocates for one node serves it for the next.
class Thinner {
 public:
  // Removes redundant voxels; returns whether that was decided for the whole node. See Thin.
  bool Thin(const TileContext& context, const ScannedSurface& scanned);

  // Of memory.
  size_t Bytes() const;

 private:
  bool Decide(const TileContext& context, const ScannedSurface& scanned);
  void FindUndecided(const TileContext& context, const ScannedSurface& scanned);
  void FindInnerAndEssential(const TileContext& context, const ScannedSurface& scanned);
  void AddInner(const Crossings& some, const TileBits& bits, bool in_set);
  void Ask(const TileContext& context, const ScannedSurface& scanned);
  void AskCandidates(const TileContext& context, BlockVoxels& voxels, const Candidates& candidates);
  bool FindPairsByBoxes(const BlockBox& where, const Candidates& candidates);
  void AskPairs(const TileContext& context, BlockVoxels& voxels);
  void UpdateList();
  void FindInUndecided(const NumberList& voxels);
  void AddBorder(const TileContext& context, BlockVoxels& voxels, std::span<const uint32_t> members);

  TileBits undecided_{0};       // members of the surface that nothing has shown essential yet; empty between nodes
  std::vector<uint32_t> list_;  // all of undecided_, each once, and voxels that have left it
  TileBits essential_{0};       // what links of tiny triangles have shown to be; empty between nodes
  Crossings inside_;            // links of tiny triangles with both ends in the surface
  NumberList outward_;          // the nearer ends of others
  Crossings inner_;             // of tiny triangles, from members of undecided_, or from what may become some
  PairMemory memory_;           // the scan's, while Thin is at work
  CrossedLinks links_;          // between members of undecided_
};

}  // namespace latvox

#endif  // LATVOX_CORE_BLOCK_THINNER_H_
