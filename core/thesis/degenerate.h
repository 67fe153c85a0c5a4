// Triangles that rounding turns into a line or a point (thesis section 4.6, figure 4.10).
#ifndef LATVOX_CORE_THESIS_DEGENERATE_H_
#define LATVOX_CORE_THESIS_DEGENERATE_H_

#include <array>
#include <vector>

#include "core/thesis/incremental.h"
#include "core/thesis/neighborhood.h"

namespace latvox {

// Discrete lines on any lattice, after Ibanez et al. (A vectorial algorithm for tracing discrete straight lines in
// N-dimensional generalized grids), the thesis's [26]: Bresenham's line with the lattice's own steps.
class LineTracer {
 public:
  explicit LineTracer(const Neighborhood& neighborhood);

  // Emits a line that the neighborhood's steps connect. It goes from one end to the other, and each voxel is a
  // k-neighbor of the one before. It writes b - a as c1*q1 + c2*q2 + c3*q3, c >= 0, with k-neighbors q that span the
  // lattice. Among these sums, it takes the one with the fewest steps, and then the one with the shortest steps. The
  // walk takes each q its c times, at each step the one whose end lies nearest to the line. The line from b to a is the
  // same.
  void Trace(const Vec3i& a, const Vec3i& b, EmitVoxel emit) const;

 private:
  using Vec3l = Vec<int64_t, 3>;
  struct Steps {
    std::array<Vec3i, 3> q;
    std::array<Vec3i, 3> inverse;  // rows of (q1 q2 q3)^-1, integers
    Vec3d length2;                 // of q, world, squared
  };
  Mat3d basis_;
  std::vector<Vec3i> neighbors_;  // sorted
  std::vector<Steps> steps_;
};

// Emits the voxels of a triangle without area: its one point, or the line between the two outermost of its points.
void DegenerateTriangle(const VoxelTriangle& triangle, const LineTracer& tracer, EmitVoxel emit);

}  // namespace latvox

#endif  // LATVOX_CORE_THESIS_DEGENERATE_H_
