// The thesis's incremental algorithms (sections 4.3 and 4.4): project the triangle along its principal direction,
// scan-convert it there, lift each point back onto the plane.
#ifndef LATVOX_CORE_THESIS_INCREMENTAL_H_
#define LATVOX_CORE_THESIS_INCREMENTAL_H_

#include <array>
#include <vector>

#include "core/base/stop_signal.h"
#include "core/thesis/neighborhood.h"

namespace latvox {

// A triangle whose vertices are voxels: the thesis rounds them first (section 4.6).
using VoxelTriangle = std::array<Vec3i, 3>;

// Returns the lattice point nearest to `point` in the world, also on lattices that are not Cartesian. Ties go to the
// lexicographically last one.
//   point   lattice coordinates
Vec3i NearestLatticePoint(const Lattice& lattice, const Vec3d& point);

// V^T times the triangle's world normal, up to a positive or negative factor, with positive first nonzero entry; zero
// if the triangle has no area.
Vec<int64_t, 3> NormalOf(const VoxelTriangle& triangle);

// Emits one voxel for each lattice line along the principal direction that meets the triangle or its border. It is the
// voxel nearest to the plane (eqs 4.4-4.7): Theorem 4's voxel with -t < d <= t. Halves go to the end with d = +t.
//   frames   of N_k
// Ends early once stopped. Precondition: the triangle has an area.
void IncrementalTriangle(const VoxelTriangle& triangle, const std::vector<Frame>& frames, StopSignal stop,
                         EmitVoxel emit);

// Does the same, with the offset k updated by additions (figure 4.8): one addition for each voxel instead of eq. 4.7.
// Rounding errors accumulate, so halves may go to either end.
//
// Eqs 4.8-4.11 lack a sign: by eq. 4.6 k falls where P'.N rises, so the increments are
//   dk_i = -N[1]/N[3],  dk_j = -N[2]/N[3].
void OptimizedIncrementalTriangle(const VoxelTriangle& triangle, const std::vector<Frame>& frames, StopSignal stop,
                                  EmitVoxel emit);

}  // namespace latvox

#endif  // LATVOX_CORE_THESIS_INCREMENTAL_H_
