// For many pairs of voxel and triangle: the lattice links at the voxel that the triangle crosses, with the voxel as the
// nearer end.
#ifndef LATVOX_CORE_SCAN_STARS_H_
#define LATVOX_CORE_SCAN_STARS_H_

#include <cstdint>
#include <span>
#include <vector>

#include "core/digitize/principal_scan.h"
#include "core/snap/snap.h"
#include "core/tile/tile_bits.h"
#include "core/tile/voxel_triangle.h"

namespace latvox {

// Bit n stands for the link along frames[n].
static_assert(kMaxDirections < 32);
struct StarLinks {
  uint32_t nearer;   // crossed, and the voxel is their nearer end
  uint32_t forward;  // links among these whose farther end is voxel + q, not voxel - q
};

// Returns the result of Star::IsNearerEnd (core/digitize/star.h) for each pair, and all directions. `out` has room for
// all pairs.
void FindStarLinks(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames, const BitsLayout& layout,
                   std::span<const VoxelTriangle> pairs, StarLinks* out);

}  // namespace latvox

#endif  // LATVOX_CORE_SCAN_STARS_H_
