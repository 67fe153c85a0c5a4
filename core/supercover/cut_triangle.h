// The part of a triangle that lies close to a row of voxels. A long triangle has only a little of its bounding box near
// it.
#ifndef LATVOX_CORE_SUPERCOVER_CUT_TRIANGLE_H_
#define LATVOX_CORE_SUPERCOVER_CUT_TRIANGLE_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/base/vec.h"
#include "core/brick/brick.h"
#include "core/digitize/crossing.h"

namespace latvox {

// A triangle, or the part of it between planes across two lattice axes: a convex polygon, in doubles. Planes are moved
// apart by a unit of 1/kLatticeUnit voxel, and Along adds one. Rounding stays below that, so the part may be too large,
// but never too small.
class CutTriangle {
 public:
  struct Range {
    double min = std::numeric_limits<double>::infinity(), max = -min;
  };

  explicit CutTriangle(const Triangle& triangle) {
    for (const Vec3i& v : triangle) Add(ToDouble(v));
  }

  // Returns the part between two planes, which may be empty. Call it at most twice in a row.
  CutTriangle Between(size_t axis, double low, double high) const {
    return Beyond(axis, 1, low - 1).Beyond(axis, -1, -high - 1);
  }

  // Returns the range of its points on an axis; min > max: there are none.
  Range Along(size_t axis) const {
    Range range;
    for (size_t n = 0; n < size_; ++n) {
      range.min = std::min(range.min, corners_[n][axis] - 1);
      range.max = std::max(range.max, corners_[n][axis] + 1);
    }
    return range;
  }

 private:
  CutTriangle() = default;

  void Add(const Vec3d& corner) { corners_[size_++] = corner; }

  // The part with sign * x >= least, with x the coordinate on the axis [Sutherland and Hodgman 1974].
  CutTriangle Beyond(size_t axis, double sign, double least) const {
    CutTriangle part;
    for (size_t n = 0; n < size_; ++n) {
      const Vec3d &a = corners_[n], &b = corners_[n + 1 < size_ ? n + 1 : 0];
      const double over_a = sign * a[axis] - least, over_b = sign * b[axis] - least;
      if (over_a >= 0) part.Add(a);
      if ((over_a >= 0) != (over_b >= 0)) part.Add(a + (b - a) * (over_a / (over_a - over_b)));
    }
    return part;
  }

  // Each plane across one of two axes adds one corner. If rounding makes corners in a plane alternate about it, a plane
  // adds half as many corners as there are: 3, 4, 6, 9, 13.
  std::array<Vec3d, 13> corners_{};
  size_t size_ = 0;
};

// Returns the voxels of a box that come within the margin (lattice units) of a triangle's bounding box, on every axis.
inline IndexBox VoxelsNear(const Triangle& triangle, const Vec3i& margin, const IndexBox& within) {
  IndexBox box;
  for (size_t m = 0; m < 3; ++m) {
    const auto [low, high] = std::minmax({triangle[0][m], triangle[1][m], triangle[2][m]});
    box.min[m] = ((low - margin[m] - 1) >> kSubvoxelBits) + 1;
    box.max[m] = ((high + margin[m]) >> kSubvoxelBits) + 1;
  }
  return Intersection(box, within);
}

// Calls f(i, j, first, end) for rows of such a box. The range k = first .. end - 1 contains each voxel of the row
// within the margin of the triangle itself, and few others. For a triangle that is short beside the margin, it is the
// whole row.
template <class F>
void ForEachRowNear(const Triangle& triangle, const Vec3i& margin, const IndexBox& box, F&& f) {
  if (IsEmpty(box)) return;
  struct Span {
    int32_t first, end;
  };
  const auto all = [&](size_t axis) { return Span{box.min[axis], box.max[axis]}; };
  const auto near = [&](const CutTriangle& part, size_t axis) {
    const auto [low, high] = part.Along(axis);
    const auto clamped = [&](double x) {
      return static_cast<int32_t>(std::clamp<double>(x, box.min[axis], box.max[axis]));
    };
    return Span{clamped(std::ceil((low - margin[axis]) / kLatticeUnit)),
                clamped(std::floor((high + margin[axis]) / kLatticeUnit) + 1)};
  };
  const auto cut = [&](const CutTriangle& part, size_t axis, int32_t at) {
    const double middle = static_cast<double>(at) * kLatticeUnit;
    return part.Between(axis, middle - margin[axis], middle + margin[axis]);
  };
  // A cut costs as much as a look at some rows, or at some voxels of a row.
  const auto exceeds = [&](size_t axis, int32_t margins) {
    return (box.max[axis] - box.min[axis]) * kLatticeUnit > margins * margin[axis];
  };
  const bool is_long_i = exceeds(0, 4), is_long_j = exceeds(1, 16);
  const CutTriangle whole(triangle);
  for (int32_t i = box.min[0]; i < box.max[0]; ++i) {
    const CutTriangle plane = is_long_i ? cut(whole, 0, i) : whole;
    const Span js = is_long_i ? near(plane, 1) : all(1);
    Span ks = is_long_i ? near(plane, 2) : all(2);
    for (int32_t j = js.first; j < js.end; ++j) {
      if (is_long_j) ks = near(cut(plane, 1, j), 2);
      if (ks.first < ks.end) f(i, j, ks.first, ks.end);
    }
  }
}

}  // namespace latvox

#endif  // LATVOX_CORE_SUPERCOVER_CUT_TRIANGLE_H_
