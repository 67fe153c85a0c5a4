// The surface's voxels in a box, from the triangles around it.
#ifndef LATVOX_CORE_BLOCK_SURFACE_SCAN_H_
#define LATVOX_CORE_BLOCK_SURFACE_SCAN_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/block/block_voxels.h"
#include "core/block/candidate_parts.h"
#include "core/block/cover_scan.h"
#include "core/block/star_batches.h"
#include "core/block/tile_context.h"
#include "core/scan/stars.h"
#include "core/tile/tile_bits.h"
#include "core/tree/tile_tree.h"

namespace latvox {

// A voxel with the links that made a triangle put it into the surface.
struct RimVoxel {
  uint32_t voxel;
  StarLinks star;
};

// The input of thinning. The scan owns all of it, until the next scan.
struct ScannedSurface {
  BlockVoxels& voxels;
  CandidateParts& candidates;          // of the triangles that are not tiny
  std::span<const RimVoxel> rim_only;  // members that no triangle crosses along its principal direction
  PairMemory& memory;
};

// The set is exact, because it is a union over triangles. Each triangle adds the nearer ends of the links that it
// crosses, or its supercover, whatever the others add. All these nearer ends are among the triangle's candidates
// (core/digitize/principal_scan.h); those of tiny triangles come from the links in the context. A candidate of a rim
// that is a member already is not tested again, which does not change the union. So neither the order of triangles nor
// their division into parts affects the set. Only the links in `rim_only` depend on the order; the thinner's result
// does not.
//
// Reuses the memory of one node for the next.
class SurfaceScan {
 public:
  // Finds all voxels of the surface in the box of `halo` steps around the node.
  //   triangles   all that come within half a step of the box, except those with links in the context; more do no harm.
  //               Must live until the node is done
  // Leaves part of the work undone once the job is cancelled.
  ScannedSurface Scan(const TileContext& context, const TileNode& node, int32_t halo,
                      std::span<const uint32_t> triangles);

  // The voxels of the last scan.
  BlockVoxels& voxels() { return voxels_; }
  const BlockVoxels& voxels() const { return voxels_; }

  // Bytes of memory.
  size_t Bytes() const;

 private:
  std::span<const uint32_t> WithoutTiny(const TileContext& context, std::span<const uint32_t> triangles);
  void AddRim(const TileContext& context, const Candidates& candidates);

  BlockVoxels voxels_;
  std::vector<uint32_t> others_;  // the triangles that are not tiny
  CandidateParts candidates_;
  CoverScan cover_;
  std::vector<RimVoxel> rim_only_;
  PairMemory memory_;
  std::vector<uint32_t> added_;  // by AddRim
};

}  // namespace latvox

#endif  // LATVOX_CORE_BLOCK_SURFACE_SCAN_H_
