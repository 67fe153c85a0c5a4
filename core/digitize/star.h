// The lattice links at one voxel that one triangle crosses.
#ifndef LATVOX_CORE_DIGITIZE_STAR_H_
#define LATVOX_CORE_DIGITIZE_STAR_H_

#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/vec.h"
#include "core/digitize/crossing.h"
#include "core/lattice/frame.h"
#include "core/snap/snap.h"

namespace latvox {

// A triangle turned so that its normal's first nonzero entry is positive, and its corners run counter-clockwise about
// the normal. The normal is a covector in lattice coordinates; it is 0 for a triangle without area.
struct OrientedTriangle {
  std::array<Vec<int64_t, 3>, 3> v;
  Vec<int64_t, 3> normal;

  explicit OrientedTriangle(const Triangle& triangle) {
    for (size_t n = 0; n < 3; ++n) v[n] = {triangle[n][0], triangle[n][1], triangle[n][2]};
    normal = Cross(v[1] - v[0], v[2] - v[0]);
    if (FirstNonzeroIsPositive(normal)) return;
    std::swap(v[1], v[2]);
    normal = -normal;
  }
};

// The star of a voxel: the links z -> z +- q for all k-neighbors q, tested against one triangle. It gives the same
// result for each link as ForEachCrossing, without a projection. Let u be the one of q and -q that goes up the normal.
// The line through z along q passes on the inner side of the triangle's edge A -> B iff u . ((B-A) x (z-A)) > 0. The
// cross products are the same for all q.
//
// Ties. A shift of the triangle by s = (e, e^2, e^3) adds s . ((B-A) x u) to that product. With d = n . (z - A) and D =
// n . u, the triangle's plane meets the line at z - (d/D) u, and the shift moves it up. So z is the nearer end iff -D/2
// < d <= D/2; the link to z+u is crossed iff -D < d <= 0, and that to z-u iff 0 < d <= D.
class Star {
 public:
  Star(const OrientedTriangle& triangle, const Vec3i& z) : normal_(triangle.normal) {
    const Vec<int64_t, 3> point{int64_t{z[0]} * kLatticeUnit, int64_t{z[1]} * kLatticeUnit,
                                int64_t{z[2]} * kLatticeUnit};
    for (size_t n = 0; n < 3; ++n) {
      edge_[n] = triangle.v[(n + 1) % 3] - triangle.v[n];
      moment_[n] = Cross(edge_[n], point - triangle.v[n]);
    }
    const Vec<int64_t, 3> offset = point - triangle.v[0];
    distance_ = 0;
    for (size_t m = 0; m < 3; ++m) distance_ += Wide{normal_[m]} * offset[m];
  }

  // Returns whether z is the nearer end of a crossed link along q; `farther` is then the step to its other end.
  bool IsNearerEnd(const Vec3i& q, Vec3i& farther) const {
    const int64_t along = Dot(normal_, q);
    const Wide size = Wide{along < 0 ? -along : along} * (kLatticeUnit / 2);
    if (!(-size < distance_ && distance_ <= size) || along == 0) return false;
    const Vec3i up = along > 0 ? q : -q;
    if (!Meets(up)) return false;
    farther = distance_ <= 0 ? up : -up;
    return true;
  }

 private:
  using Wide = __int128;

  // Returns whether the whole line through z along u meets the triangle.
  bool Meets(const Vec3i& u) const {
    for (size_t n = 0; n < 3; ++n) {
      const int64_t side = Dot(moment_[n], u);
      if (side < 0 || (side == 0 && !TieIsInside(edge_[n], u))) return false;
    }
    return true;
  }

  static bool TieIsInside(const Vec<int64_t, 3>& edge, const Vec3i& u) {
    return FirstNonzeroIsPositive(Cross(edge, Vec<int64_t, 3>{u[0], u[1], u[2]}));
  }

  const Vec<int64_t, 3>& normal_;
  std::array<Vec<int64_t, 3>, 3> edge_, moment_;
  Wide distance_;  // n . (z - A), in units of 1/kLatticeUnit
};

}  // namespace latvox

#endif  // LATVOX_CORE_DIGITIZE_STAR_H_
