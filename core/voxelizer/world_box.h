// A closed box of the world, as the lattice points within it.
#ifndef LATVOX_CORE_VOXELIZER_WORLD_BOX_H_
#define LATVOX_CORE_VOXELIZER_WORLD_BOX_H_

#include <cstddef>

#include "core/base/vec.h"
#include "core/brick/brick.h"
#include "core/lattice/grid.h"
#include "core/mesh/mesh.h"

namespace latvox {

// The points whose positions origin + i*a + j*b + k*c, computed without rounding from the doubles of the grid, lie in
// the box, faces included. Coordinates are ijk. Exact: most comparisons are decided in doubles, with a bound on what
// these may be wrong by, the rest in integers of any length.
//
// Boxes of lattice points are taken by their corners: both sets are convex.
class WorldBox {
 public:
  // Precondition: bounds are finite, and min <= max on every axis.
  WorldBox(const Grid& grid, const Bounds& bounds)
      : basis_(grid.lattice.basis()), inverse_(grid.lattice.inverse()), origin_(grid.origin), bounds_(bounds) {}

  bool Contains(const Vec3i& ijk) const;

  // Of all points of a box that is not empty: whether each is in, and whether all lie beyond the same face.
  bool ContainsAll(const IndexBox& box) const;
  bool Misses(const IndexBox& box) const;

  // A box within `box` that holds all points of that which are in; empty, and at 0, if it finds none. About the least
  // one, which on a skew basis may hold many points that are out.
  IndexBox Around(const IndexBox& box) const;

  // Removes the voxels that are out, with their values, and bricks that are left empty.
  void Clip(TileBricks& tile) const;

 private:
  int SideOf(size_t axis, const Vec3i& ijk) const;
  int Compare(size_t axis, const Vec3i& ijk, double limit) const;
  void Clip(Brick& brick) const;

  Mat3d basis_, inverse_;
  Vec3d origin_;
  Bounds bounds_;
};

// No fewer than there are lattice points in the box, but for rounding.
double MostPointsIn(const Grid& grid, const Bounds& bounds);

}  // namespace latvox

#endif  // LATVOX_CORE_VOXELIZER_WORLD_BOX_H_
