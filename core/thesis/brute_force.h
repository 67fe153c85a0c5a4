// The thesis's brute force algorithm (section 4.2): tests every lattice point of a box around a triangle against the
// regions L_p, L_e and L_v (section 4.1, figure 4.2).
#ifndef LATVOX_CORE_THESIS_BRUTE_FORCE_H_
#define LATVOX_CORE_THESIS_BRUTE_FORCE_H_

#include "core/base/stop_signal.h"
#include "core/digitize/crossing.h"
#include "core/thesis/neighborhood.h"

namespace latvox {

// Emits every voxel z (local) in one of
//   L_p  -t < d(z) <= t, with d the signed distance to the triangle's plane and t = max |n.q| / 2 over N_k (Theorems
//        4-7). The normal's first nonzero entry in lattice coordinates is positive. Also, z lies between three planes,
//        or on one: each contains an edge and is perpendicular to the triangle's plane
//   L_e  within R of an edge      L_v  within R of a vertex (both closed, see Tube)
// A triangle without area has no L_p.
//
// It walks the triangle's bounding box in lattice coordinates with a margin of two voxels. On a skewed basis, R may
// need a wider margin. Cost: O(D^3) for a triangle D voxels long (figure 4.5). Ends early once stopped.
void BruteForceTriangle(const Triangle& triangle, const Neighborhood& neighborhood, StopSignal stop, EmitVoxel emit);

}  // namespace latvox

#endif  // LATVOX_CORE_THESIS_BRUTE_FORCE_H_
