#include "core/thesis/neighborhood.h"

#include <algorithm>
#include <cmath>

namespace latvox {
namespace {

// Half the diagonal of the box of the Gram-Schmidt vectors: rounding one coefficient after the other (Babai's nearest
// plane) ends at a lattice point within that box around the point.
double CoveringRadiusBound(const Mat3d& basis) {
  Mat3d star = basis;
  double sum = 0;
  for (size_t c = 0; c < 3; ++c) {
    for (size_t before = 0; before < c; ++before) {
      star[c] = star[c] - star[before] * (Dot(basis[c], star[before]) / Dot(star[before], star[before]));
    }
    sum += Dot(star[c], star[c]);
  }
  return std::sqrt(sum) / 2;
}

}  // namespace

Neighborhood::Neighborhood(const Lattice& of, int k)
    : lattice(of), frames(of.frames(k)), radius(0), ball{}, covering_radius_max(CoveringRadiusBound(of.basis())) {
  for (const Frame& frame : frames) {
    const Vec3d step = Apply(lattice.basis(), frame.q);
    radius = std::max(radius, LengthOf(step) / 2);
  }
  for (size_t m = 0; m < 3; ++m) {
    const Vec3d row{lattice.inverse()[0][m], lattice.inverse()[1][m], lattice.inverse()[2][m]};
    ball[m] = radius * (1 + kSymmetryTolerance) * LengthOf(row);
  }
}

Tube::Tube(const Neighborhood& neighborhood, const Vec3d& a, const Vec3d& b)
    : basis_(neighborhood.lattice.basis()),
      a_(a),
      edge_(Apply(basis_, b - a)),
      length2_(Dot(edge_, edge_)),
      radius2_(neighborhood.radius * neighborhood.radius * (1 + 2 * kSymmetryTolerance)) {}

bool Tube::Contains(const Vec3d& point) const {
  const Vec3d from_a = Apply(basis_, point - a_);
  const double along = length2_ > 0 ? std::clamp(Dot(from_a, edge_) / length2_, 0.0, 1.0) : 0;
  const Vec3d from_axis = from_a - edge_ * along;
  return Dot(from_axis, from_axis) <= radius2_;
}

}  // namespace latvox
