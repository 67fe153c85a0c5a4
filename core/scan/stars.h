// Many voxel-triangle pairs: which lattice edges at the voxel the triangle crosses, with the voxel as the nearer end.
#ifndef LATVOX_CORE_SCAN_STARS_H_
#define LATVOX_CORE_SCAN_STARS_H_

#include <cstdint>
#include <span>
#include <vector>

#include "core/digitize/principal_scan.h"
#include "core/snap/snap.h"
#include "core/tile/tile_bits.h"

namespace latvox {

struct VoxelTriangle {
  uint32_t voxel;     // a number of the layout
  uint32_t triangle;  // of the mesh
};

// Bit n stands for the edge along frames[n].
static_assert(kMaxDirections < 32);
struct StarLinks {
  uint32_t nearer;   // crossed, and the voxel is their nearer end
  uint32_t forward;  // of these, the farther end is voxel + q, not voxel - q
};

// What Star::IsNearerEnd (core/digitize/star.h) says of each pair, for all directions. `out` has room for all pairs.
void FindStarLinks(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames, const BitsLayout& layout,
                   std::span<const VoxelTriangle> pairs, StarLinks* out);

}  // namespace latvox

#endif  // LATVOX_CORE_SCAN_STARS_H_
