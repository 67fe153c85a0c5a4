#include "core/thesis/brute_force.h"

#include <algorithm>
#include <cmath>

namespace latvox {
namespace {

constexpr double kMargin = 2;  // voxels around the bounding box, figure 4.4

Vec3d ToVoxels(const Vec3i& v_lat) { return ToDouble(v_lat) * (1.0 / kLatticeUnit); }

// The covector in lattice coordinates of x -> normal . x (world).
Vec3d Covector(const Mat3d& basis, const Vec3d& normal) {
  return {Dot(basis[0], normal), Dot(basis[1], normal), Dot(basis[2], normal)};
}

// L_p. The normal is the cross product of two edges in lattice coordinates, which is V^T times the world normal up to a
// factor. So its entries, and distances in its units, are exact in doubles for triangles up to hundreds of voxels, and
// even ties are decided right. The thesis's section 5.4 reports the redundant voxels of a version where they are not.
class Slab {
 public:
  Slab(const std::array<Vec3d, 3>& v, const Neighborhood& neighborhood) : v_(v) {
    const Mat3d& basis = neighborhood.lattice.basis();
    normal_ = Cross(v[1] - v[0], v[2] - v[0]);
    if (!FirstNonzeroIsPositive(normal_)) normal_ = -normal_;
    for (const Frame& frame : neighborhood.frames) two_t_ = std::max(two_t_, std::abs(Dot(normal_, frame.q)));
    const Vec3d world_normal = Cross(Apply(basis, v[1] - v[0]), Apply(basis, v[2] - v[0]));
    for (size_t n = 0; n < 3; ++n) {
      inward_[n] = Covector(basis, Cross(world_normal, Apply(basis, v[(n + 1) % 3] - v[n])));
    }
    // |normal . x| <= |world covector of normal| |V x|
    const Mat3d& inverse = neighborhood.lattice.inverse();
    Vec3d gradient;
    for (size_t m = 0; m < 3; ++m) gradient[m] = Dot(inverse[m], normal_);
    far_ = neighborhood.radius * LengthOf(gradient) * (1 + kSymmetryTolerance);
  }

  // normal . (point - v0): the signed distance times the normal's length.
  double Distance(const Vec3d& point) const { return Dot(normal_, point - v_[0]); }
  // Returns whether a point at this distance is farther than R from the plane, and so from every region (t <= R).
  bool IsFar(double distance) const { return std::abs(distance) > far_; }

  bool Contains(const Vec3d& point, double distance) const {
    if (!(-two_t_ < 2 * distance && 2 * distance <= two_t_)) return false;
    for (size_t n = 0; n < 3; ++n) {
      if (Dot(inward_[n], point - v_[n]) < 0) return false;
    }
    return two_t_ > 0;
  }

 private:
  std::array<Vec3d, 3> v_;
  Vec3d normal_;
  double two_t_ = 0, far_ = 0;
  std::array<Vec3d, 3> inward_;
};

// The box's integer points, both ends included.
struct Range {
  Vec3i low, high;
};

Range BoxAround(const std::array<Vec3d, 3>& v, const Vec3d& ball) {
  Range range;
  for (size_t m = 0; m < 3; ++m) {
    const auto [low, high] = std::minmax({v[0][m], v[1][m], v[2][m]});
    const double margin = std::max(kMargin, ball[m]);
    range.low[m] = static_cast<int32_t>(std::floor(low - margin));
    range.high[m] = static_cast<int32_t>(std::ceil(high + margin));
  }
  return range;
}

}  // namespace

void BruteForceTriangle(const Triangle& triangle, const Neighborhood& neighborhood, StopSignal stop, EmitVoxel emit) {
  const std::array<Vec3d, 3> v{ToVoxels(triangle[0]), ToVoxels(triangle[1]), ToVoxels(triangle[2])};
  const Slab slab(v, neighborhood);
  const std::array<Tube, 3> tubes{Tube(neighborhood, v[0], v[1]), Tube(neighborhood, v[1], v[2]),
                                  Tube(neighborhood, v[2], v[0])};
  const Range box = BoxAround(v, neighborhood.ball);
  for (int32_t i = box.low[0]; i <= box.high[0]; ++i) {
    for (int32_t j = box.low[1]; j <= box.high[1] && !stop.Stopped(); ++j) {
      for (int32_t k = box.low[2]; k <= box.high[2]; ++k) {
        const Vec3i z{i, j, k};
        const Vec3d point = ToDouble(z);
        const double distance = slab.Distance(point);
        if (slab.IsFar(distance)) continue;
        if (slab.Contains(point, distance) ||
            std::any_of(tubes.begin(), tubes.end(), [&](const Tube& tube) { return tube.Contains(point); })) {
          emit(z);
        }
      }
    }
  }
}

}  // namespace latvox
