// The supercover on lattices whose cells are boxes along the lattice axes, such as the Cartesian one.
//
// The corners of the cell of 0 are then (+-1, +-1, +-1) / 2, half of links. That has two consequences for a triangle
// with normal n and principal direction C (core/digitize/principal_scan.h):
// (1) The cell reaches as far along n as half of C does. So the voxels whose cells meet the triangle's plane are those
//     with -t <= d <= t, where t = |n.C|/2. One voxel of each line along C has -t < d <= t. A second one has d = -t,
//     and only where d = t for the first.
// (2) The cell reaches as far across an edge as half of some link does, and that defines the rim.
// So the scan for k = 0 finds the supercover, too. A line that meets the triangle gives a voxel of it at once, because
// the crossing lies on half of a link. A voxel of the rim is in the supercover iff no axis separates its cell from the
// triangle. The plane is no such axis there.
//
// Two things are lost where cells and triangle just touch. The scan takes one voxel of a line with d = +-t. In lanes,
// it may take none where an edge function is exactly minus the rim. In lattice units, with U = kLatticeUnit, v a corner
// and g = edge x C, voxels have whole multiples of U as coordinates, so
//   d = +-t                    only if n.v + (n_0 + n_1 + n_2) U/2 is a multiple of U
//   edge function = -rim       only if g.v + (g_0 + g_1 + g_2) U/2 is a multiple of U
// One in 64 triangles in general position has such a sum. Dividing n and g by their common divisors first spares
// most of the others. The remaining triangles are left to Supercover.
#ifndef LATVOX_CORE_SUPERCOVER_BOX_CELLS_H_
#define LATVOX_CORE_SUPERCOVER_BOX_CELLS_H_

#include <cstdint>
#include <vector>

#include "core/digitize/crossing.h"
#include "core/tile/tile_bits.h"
#include "core/tile/voxel_triangle.h"

namespace latvox {

// Returns whether the scan for k = 0 finds all voxels whose cells meet the triangle. False for one without area.
bool ScanFindsCover(const Triangle& triangle);

// Keeps the pairs whose cell meets the triangle.
//   is_near   true: each voxel is a candidate of its triangle's scan, so that its cell meets the triangle's plane
//             false: each triangle is smaller than kSmallCells voxels along each axis, and each voxel is in its box
void KeepMeeting(const SnappedMesh& mesh, const BitsLayout& layout, bool is_near, std::vector<VoxelTriangle>& pairs);

// With such corners, the normal takes 25 bits and its product with a corner 38. They fit doubles.
inline constexpr int32_t kSmallCells = 8;

}  // namespace latvox

#endif  // LATVOX_CORE_SUPERCOVER_BOX_CELLS_H_
