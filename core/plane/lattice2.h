// Two-dimensional lattices: bases, neighbours, scan directions. The plane's counterpart of core/lattice.
//
// A lattice is { V*ij : ij in Z^2 }; its points are called pixels, and the Voronoi cell of one is a rectangle or a
// hexagon (thesis section 3.1, figure 3.2).
#ifndef LATVOX_CORE_PLANE_LATTICE2_H_
#define LATVOX_CORE_PLANE_LATTICE2_H_

#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/vec.h"
#include "core/lattice/neighbors.h"

namespace latvox {

using Vec2d = Vec<double, 2>;
using Vec2i = Vec<int32_t, 2>;
using Vec2l = Vec<int64_t, 2>;
using Mat2d = Mat<double, 2>;

// Bound on the sum of absolute entries of a direction q, and so on a frame's rows; the widths in core/plane rest on it.
inline constexpr int kPlaneStepBits = 4;
inline constexpr int kMaxPlaneStep = 1 << kPlaneStepBits;

// A unimodular change of lattice coordinates that turns the direction q into the last axis:
//   (a, c) = R * ij     a numbers the lattice lines along q; c counts pixels on the line
//   ij = a*u[0] + c*u[1],   u[1] = q
// (1) R = U^-1, det R = det U = 1   (2) r[0] = (q[1], -q[0])   (3) every row has absolute sum <= kMaxPlaneStep
struct PlaneFrame {
  Vec2i q;
  std::array<Vec2i, 2> r;  // rows of R
  std::array<Vec2i, 2> u;  // columns of U
};

// Whether the first nonzero entry is positive. It picks one of each pair +-v.
template <class T>
constexpr bool FirstNonzeroIsPositive(const Vec<T, 2>& v) {
  return v[0] != 0 ? v[0] > 0 : v[1] > 0;
}

// The frame along a line's principal direction (thesis Definition 2): the first with the largest |normal . q|.
//   normal   covector in lattice coordinates, V^T times the world normal: then normal . q is the world inner product
// Precondition: frames is not empty.
const PlaneFrame& PrincipalFrame(const std::vector<PlaneFrame>& frames, const Vec2l& normal);

enum class NamedPlaneLattice { kSquare, kHexagonal };

class PlaneLattice {
 public:
  // The named lattice, scaled so that pixel_size() is 1. Columns up to scale:
  //   kSquare      (1,0) (0,1)
  //   kHexagonal   (1,0) (1/2,sqrt(3)/2)
  static PlaneLattice Named(NamedPlaneLattice name);

  // The lattice with columns V, world units. Errors: INVALID_ARGUMENT if an entry is not finite, if V is singular, or
  // if it is too skew, which is to say that a k-neighbour has an absolute sum over kMaxPlaneStep; the message then
  // gives a basis of the same lattice that is not.
  static absl::StatusOr<PlaneLattice> FromBasis(const Mat2d& basis);

  // The same lattice scaled uniformly to pixel_size. Precondition: pixel_size is finite and > 0.
  absl::StatusOr<PlaneLattice> Scaled(double pixel_size) const;

  const Mat2d& basis() const { return basis_; }      // V, world units
  const Mat2d& inverse() const { return inverse_; }  // V^-1, by columns
  std::string_view name() const { return name_; }    // "square", "hexagonal" or "basis"
  double pixel_size() const;                         // |det V|^(1/2): edge of a square with a cell's area

  // Every lattice vector whose Voronoi cell meets the origin's, with the dimension of the shared face.
  const std::vector<Neighbor<2>>& neighbors() const { return neighbors_; }

  // The frames of one of each pair +-q of k-neighbours, in lexicographic order of q; q's first nonzero entry is
  // positive. k = 1: cells share an edge; k = 0: or a vertex.
  const std::vector<PlaneFrame>& frames(int k) const { return frames_[static_cast<size_t>(k)]; }

 private:
  PlaneLattice(std::string_view name, const Mat2d& basis, const Mat2d& inverse)
      : name_(name), basis_(basis), inverse_(inverse) {}
  static absl::StatusOr<PlaneLattice> Make(std::string_view name, const Mat2d& basis);

  std::string_view name_;
  Mat2d basis_, inverse_;
  std::vector<Neighbor<2>> neighbors_;
  std::array<std::vector<PlaneFrame>, 2> frames_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_PLANE_LATTICE2_H_
