// The thesis's minimality ratio R (section 5.1, Theorem 8): the share of surface voxels that do not keep inside and
// outside apart.
#ifndef LATVOX_CORE_VERIFY_MINIMALITY_H_
#define LATVOX_CORE_VERIFY_MINIMALITY_H_

#include <cstdint>
#include <vector>

#include "core/verify/water.h"

namespace latvox {

// A voxel in the discrete plane of one piece of the surface.
struct PlaneVoxel {
  Vec3i ijk;
  Vec3i direction;  // the plane's principal direction C, a lattice vector
  uint32_t plane;   // triangles of one plane should share a number
};

// Counts of distinct voxels. A voxel is one of the last four.
struct Minimality {
  uint64_t voxels = 0;
  uint64_t minimal = 0;           // Theorem 8: of z + C and z - C one is inside, the other water
  uint64_t at_seam = 0;           // excluded, figure 5.3 case 1
  uint64_t by_other_surface = 0;  // excluded, case 2
  uint64_t redundant = 0;         // the rest

  // R = 1 - minimal / voxels, without the excluded voxels in both; 0 if none is left.
  double Ratio() const;
};

// Checks each voxel against Theorem 8. The planes of a voxel decide on the exclusions:
//   case 1   the voxel has two planes or more: it lies where they meet
//   case 2   a neighbor along C has another plane. (A neighbor that has only the voxel's own plane does not count,
//            because a plane has one voxel on each line along C.)
//   voxels   each once for every plane that it is in, in any order
//   flood    of the same voxels, in a volume that contains all of them; beyond it there is water
Minimality MeasureMinimality(std::vector<PlaneVoxel> voxels, const Flood& flood);

}  // namespace latvox

#endif  // LATVOX_CORE_VERIFY_MINIMALITY_H_
