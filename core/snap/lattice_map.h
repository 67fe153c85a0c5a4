// The affine map from world to lattice coordinates, and its rounding, over arrays of vertices.
#ifndef LATVOX_CORE_SNAP_LATTICE_MAP_H_
#define LATVOX_CORE_SNAP_LATTICE_MAP_H_

#include <cstddef>
#include <limits>

#include "core/base/vec.h"

namespace latvox {

// p -> V^-1 (p - origin).
struct LatticeMap {
  Mat3d inverse;  // V^-1, by columns
  Vec3d origin;   // world units
};

// A box of unrounded lattice coordinates, closed. At first it is empty.
struct LatticeRange {
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vec3d min{kInfinity, kInfinity, kInfinity}, max{-kInfinity, -kInfinity, -kInfinity};
  void Add(const LatticeRange& other);
};

// The range of `count` vertices.
LatticeRange RangeOf(const LatticeMap& map, const Vec3f* vertices, size_t count);
LatticeRange RangeOf(const LatticeMap& map, const Vec3d* vertices, size_t count);

// Clamps the lattice coordinates of `count` vertices to `range` and rounds them half to even to multiples of
// 1/kLatticeUnit, which out[n] counts from `base_ijk`.
//   out   may be where float vertices are: each is read before it is written
// Preconditions: the range is not empty, |range| <= 2^kPositionBits, and out[n] fits int32.
void RoundVertices(const LatticeMap& map, const LatticeRange& range, const Vec3i& base_ijk, const Vec3f* vertices,
                   size_t count, Vec3i* out);
void RoundVertices(const LatticeMap& map, const LatticeRange& range, const Vec3i& base_ijk, const Vec3d* vertices,
                   size_t count, Vec3i* out);

}  // namespace latvox

#endif  // LATVOX_CORE_SNAP_LATTICE_MAP_H_
