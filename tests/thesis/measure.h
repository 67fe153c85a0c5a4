// The thesis's validation (section 5.1) and the exact counts, for one tetrahedron.
#ifndef LATVOX_TESTS_THESIS_MEASURE_H_
#define LATVOX_TESTS_THESIS_MEASURE_H_

#include "core/request/algorithm.h"
#include "core/verify/minimality.h"
#include "core/verify/verify.h"
#include "tests/thesis/experiment.h"

namespace latvox::thesis {

struct Measurement {
  uint64_t voxels = 0;
  double displaced = 0;  // Delta(V), eq. 5.1
  Minimality minimality;
  Verdict given;    // against the tetrahedron as given
  Verdict rounded;  // against the tetrahedron with vertices at lattice points, which the incremental algorithms see
};

// Returns the voxels of a mesh by the named algorithm, as the library delivers them.
VoxelSet VoxelsBy(Algorithm algorithm, const TriangleMesh& mesh, const Grid& grid, int k);

// Returns the mesh with its vertices at the nearest lattice points.
SnappedMesh Rounded(SnappedMesh mesh, const Lattice& lattice);

// Measures one tetrahedron. R needs to know which triangle's plane a voxel belongs to:
//   exact          it is the nearer end of a link that the triangle crosses, or within R of the triangle's
//   edges
//                  (Theorem 8 looks along one direction, but near edges a voxel may be needed for another)
//   brute force    it lies in one of the triangle's three regions
//   incremental    the triangle's scan gives it, or the seam of one of its edges
// Aborts if these voxels are not those of VoxelsBy.
Measurement Measure(const Experiment& experiment, double degrees, Algorithm algorithm);

}  // namespace latvox::thesis

#endif  // LATVOX_TESTS_THESIS_MEASURE_H_
