// The k-neighborhood of a lattice, with the measures of the thesis's algorithms.
//
// The thesis's own algorithms (its chapter 4) are here under their names, for comparison with the crossing rule
// (core/digitize). They start from the same snapped surface as the rule, and compute in doubles.
//
// Frames:  lattice coordinates ijk, local (relative to SnappedMesh::base_ijk): Vec3i a voxel, Vec3d any point;
//          a plane's normal is a covector in them; lengths are world lengths, |V * ijk|.
#ifndef LATVOX_CORE_THESIS_NEIGHBORHOOD_H_
#define LATVOX_CORE_THESIS_NEIGHBORHOOD_H_

#include <vector>

#include "absl/functional/function_ref.h"
#include "core/base/vec.h"
#include "core/lattice/lattice.h"

namespace latvox {

// Takes a voxel; may be called with one voxel several times.
using EmitVoxel = absl::FunctionRef<void(const Vec3i&)>;

struct Neighborhood {
  Neighborhood(const Lattice& of, int k);

  const Lattice& lattice;
  const std::vector<Frame>& frames;  // of N_k, one of each pair +-q
  double radius;                     // R, section 4.1: the largest interface distance, max |V*q| / 2 over N_k
  Vec3d ball;                        // the reach of a ball of radius R along each lattice axis
  double covering_radius_max;        // no point is farther than this from all lattice points
};

// The points within R of a segment: the regions L_e and, as its round ends, L_v of section 4.1. The tube is closed: a
// link of length 2R that the segment halves has both ends at distance R, and one must be in. For the same reason,
// lengths that equal R within the lattice's own tolerance count as R.
class Tube {
 public:
  Tube(const Neighborhood& neighborhood, const Vec3d& a, const Vec3d& b);
  bool Contains(const Vec3d& point) const;

 private:
  const Mat3d& basis_;
  Vec3d a_;     // lattice coordinates
  Vec3d edge_;  // world
  double length2_, radius2_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_THESIS_NEIGHBORHOOD_H_
