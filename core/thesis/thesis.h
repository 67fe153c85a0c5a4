// The thesis's algorithms on whole meshes.
#ifndef LATVOX_CORE_THESIS_THESIS_H_
#define LATVOX_CORE_THESIS_THESIS_H_

#include <vector>

#include "absl/status/statusor.h"
#include "core/base/stop_signal.h"
#include "core/brick/voxel_set.h"
#include "core/lattice/grid.h"
#include "core/mesh/mesh.h"
#include "core/request/algorithm.h"
#include "core/snap/snap.h"

namespace latvox {

// Returns the voxels of an algorithm, neither thinned nor clipped. Coordinates ijk, not local.
//   kBruteForce   section 4.2, on the snapped mesh
//   kIncremental, kOptimizedIncremental
//                 sections 4.3 and 4.4 on the mesh with its vertices rounded to lattice points (section 4.6). Seams are
//                 those of section 4.5. Triangles that rounding leaves without area become points and 0-connected
//                 lines. Rounding moves the surface by up to the covering radius of the lattice, so the set separates
//                 the rounded surface, not the mesh.
//   k             0, 1 or 2
// Parallel over triangles in the oneTBB arena of the calling thread; the set does not depend on it. Memory: the set,
// and 12 bytes for each edge of a triangle. Errors: CANCELLED once stopped. Precondition: algorithm is not kExact.
absl::StatusOr<VoxelSet> VoxelizeByThesis(const SnappedMesh& mesh, const Lattice& lattice, int k, Algorithm algorithm,
                                          StopSignal stop);

// Does the same from world coordinates. Further errors: as Snap. Precondition: CheckMesh(mesh).
absl::StatusOr<VoxelSet> VoxelizeByThesis(const TriangleMesh& mesh, const Grid& grid, int k, Algorithm algorithm,
                                          StopSignal stop);

// The nearest lattice points of the mesh's vertices, local.
std::vector<Vec3i> RoundedVertices(const SnappedMesh& mesh, const Lattice& lattice, StopSignal stop = {});

// For Snap: per axis, twice the distance from the mesh beyond which the algorithm sets no voxel.
Vec3i ThesisReach(const Lattice& lattice, int k, Algorithm algorithm);

}  // namespace latvox

#endif  // LATVOX_CORE_THESIS_THESIS_H_
