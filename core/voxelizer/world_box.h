// A closed box of the world, as a set of lattice points.
#ifndef LATVOX_CORE_VOXELIZER_WORLD_BOX_H_
#define LATVOX_CORE_VOXELIZER_WORLD_BOX_H_

#include <cstddef>

#include "core/base/vec.h"
#include "core/brick/brick.h"
#include "core/lattice/grid.h"
#include "core/mesh/mesh.h"

namespace latvox {

// The set of points whose positions origin + i*a + j*b + k*c lie in the box, faces included. Positions follow from the
// doubles of the grid without rounding. Coordinates are ijk. The result is exact: doubles decide most comparisons, with
// a bound on their error, and integers of any length decide the rest.
//
// For boxes of lattice points, their corners decide, because both sets are convex.
class WorldBox {
 public:
  // Precondition: bounds are finite, and min <= max on every axis.
  WorldBox(const Grid& grid, const Bounds& bounds)
      : basis_(grid.lattice.basis()), inverse_(grid.lattice.inverse()), origin_(grid.origin), bounds_(bounds) {}

  bool Contains(const Vec3i& ijk) const;

  // For a box that is not empty: whether all its points are in the set, and whether all lie beyond the same face.
  bool ContainsAll(const IndexBox& box) const;
  bool Misses(const IndexBox& box) const;

  // Returns a box within `box` that holds all of its points that are in the set. It is empty, and at 0, if it finds
  // none. It is about the smallest such box; on a skewed basis, that may hold many other points.
  IndexBox Around(const IndexBox& box) const;

  // Removes voxels outside of the set, with their values, and bricks that become empty.
  void Clip(TileBricks& tile) const;

 private:
  int SideOf(size_t axis, const Vec3i& ijk) const;
  int Compare(size_t axis, const Vec3i& ijk, double limit) const;
  void Clip(Brick& brick) const;

  Mat3d basis_, inverse_;
  Vec3d origin_;
  Bounds bounds_;
};

// An upper bound on the number of lattice points in the box, except for rounding.
double MostPointsIn(const Grid& grid, const Bounds& bounds);

}  // namespace latvox

#endif  // LATVOX_CORE_VOXELIZER_WORLD_BOX_H_
