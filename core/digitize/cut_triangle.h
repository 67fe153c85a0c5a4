// Which part of a triangle lies close to a row of voxels: of a long one that crosses its bounding box, little does.
#ifndef LATVOX_CORE_DIGITIZE_CUT_TRIANGLE_H_
#define LATVOX_CORE_DIGITIZE_CUT_TRIANGLE_H_

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

#include "core/base/vec.h"
#include "core/digitize/crossing.h"

namespace latvox {

// A triangle, or what is left of it between planes across lattice axes: a convex polygon. It may be too large by a
// unit of 1/kLatticeUnit voxel, which rounding does not exceed; never too small.
class CutTriangle {
 public:
  struct Range {
    double min = std::numeric_limits<double>::infinity(), max = -min;
  };

  explicit CutTriangle(const Triangle& triangle) {
    for (const Vec3i& v : triangle) Add(ToDouble(v));
  }

  // The part between two planes, which may be nothing.
  CutTriangle Between(size_t axis, double low, double high) const {
    return Beyond(axis, 1, low - 1).Beyond(axis, -1, -high - 1);
  }

  // Where its points lie on an axis; min > max: nowhere.
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

  // The part with sign * x >= least, x the coordinate on the axis [Sutherland and Hodgman 1974].
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

  // Each plane adds one corner at most; no more than two axes are cut.
  std::array<Vec3d, 3 + 4> corners_;
  size_t size_ = 0;
};

}  // namespace latvox

#endif  // LATVOX_CORE_DIGITIZE_CUT_TRIANGLE_H_
