// Whether brute force suffers from the precision of its numbers (thesis section 5.4), on vertices that are not snapped.
#ifndef LATVOX_TESTS_THESIS_PRECISION_H_
#define LATVOX_TESTS_THESIS_PRECISION_H_

#include <cstdint>
#include <vector>

#include "tests/thesis/experiment.h"
#include "tests/thesis/plan.h"

namespace latvox::thesis {

// Over the interiors of planes: the lattice points that lie between the three planes through a triangle's edges, and
// farther than R from these. There region L_p decides alone.
struct PrecisionCounts {
  uint64_t planes = 0;   // triangles
  uint64_t voxels = 0;   // in the slab -t < n.z + D <= t of Theorem 4, as the numbers of the algorithm say
  uint64_t doubled = 0;  // pairs of voxels on one line along the principal direction; exactly, there is one voxel
  uint64_t empty = 0;    // lines along it that exactly have a voxel, and here have none
  uint64_t wrong = 0;    // lattice points that are exactly in the slab, and here are not, or the other way round
};

struct PrecisionRow {
  LatticeCase lattice_case;
  int32_t resolution;
  const char* placement;  // "rotated": the tetrahedra of the experiment; "ties": a plane with voxels at exactly -t, t
  const char* precision;  // "single" or "double"
  PrecisionCounts counts;
};

// Brute force tests each lattice point of a box. It computes unit normal, D and t in world coordinates from vertices
// rounded to the precision. Rationals of unlimited size judge, from the same vertices.
std::vector<PrecisionRow> PrecisionRows(const Plan& plan);

}  // namespace latvox::thesis

#endif  // LATVOX_TESTS_THESIS_PRECISION_H_
