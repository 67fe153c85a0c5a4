// Lattices in two and three dimensions: bases, neighbors, scan directions.
//
// A lattice is { V*ijk : ijk in Z^D }; the columns of the sampling matrix V are its basis vectors (thesis section 2.1).
// Points in space are called voxels, and those in the plane pixels (section 3.1, figure 3.2).
#ifndef LATVOX_CORE_LATTICE_LATTICE_H_
#define LATVOX_CORE_LATTICE_LATTICE_H_

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/vec.h"
#include "core/lattice/frame.h"
#include "core/lattice/named.h"
#include "core/lattice/neighbors.h"

namespace latvox {

template <size_t D>
class BasicLattice {
 public:
  // The named lattice, scaled so that a cell's volume is 1. Its directions are found once in a process.
  static BasicLattice Named(LatticeName<D> lattice);

  // Returns the lattice with columns V, world units. Errors: INVALID_ARGUMENT if an entry is not finite, if V is
  // singular, or if V is too skewed: a frame would exceed the bounds in frame.h. Then the message gives an equivalent
  // basis that is not too skewed.
  static absl::StatusOr<BasicLattice> FromBasis(const Mat<double, D>& basis);

  // Returns the same lattice, scaled uniformly to this voxel_size or pixel_size. Scaling changes no length beside
  // another one, so both lattices share their directions. Precondition: the size is finite and > 0. Errors:
  // INVALID_ARGUMENT if the determinant over- or underflows.
  absl::StatusOr<BasicLattice> Scaled(double size) const;

  const Mat<double, D>& basis() const { return basis_; }      // V, world units
  const Mat<double, D>& inverse() const { return inverse_; }  // V^-1, by columns

  // The name of a named lattice, or "basis". In space, a given basis also has a name if it is the basis of a named
  // lattice up to scale. If the scales along the axes differ, "stretched-" precedes the name. Bases are compared as
  // they are, within kSymmetryTolerance: another basis of the same lattice, or a rotated one, is "basis".
  std::string_view name() const { return name_; }

  // |det V|^(1/3): edge of a cube with a cell's volume, eq. 5.2.
  double voxel_size() const requires(D == 3) { return Size(); }
  // |det V|^(1/2): edge of a square with a cell's area.
  double pixel_size() const requires(D == 2) { return Size(); }

  // Every lattice vector with a Voronoi cell that meets the origin's, with the dimension of the shared face.
  const std::vector<Neighbor<D>>& neighbors() const { return directions_->neighbors; }

  // The frames of the k-neighbors, one for each pair +-q, in lexicographic order of q. The first nonzero entry of q is
  // positive. k in 0 .. D-1.
  const std::vector<BasicFrame<D>>& frames(int k) const { return directions_->frames[static_cast<size_t>(k)]; }

 private:
  // All that the basis decides up to its scale.
  struct Directions {
    std::vector<Neighbor<D>> neighbors;
    std::array<std::vector<BasicFrame<D>>, D> frames;
  };

  BasicLattice(std::string_view name, const Mat<double, D>& basis, const Mat<double, D>& inverse,
               std::shared_ptr<const Directions> directions)
      : name_(name), basis_(basis), inverse_(inverse), directions_(std::move(directions)) {}
  static absl::StatusOr<BasicLattice> Make(std::string_view name, const Mat<double, D>& basis);
  static absl::StatusOr<Directions> FindDirections(const Mat<double, D>& basis, const Mat<int32_t, D>& reduction);
  double Size() const;

  std::string_view name_;
  Mat<double, D> basis_, inverse_;
  std::shared_ptr<const Directions> directions_;
};

using Lattice = BasicLattice<3>;
using PlaneLattice = BasicLattice<2>;

extern template class BasicLattice<2>;
extern template class BasicLattice<3>;

}  // namespace latvox

#endif  // LATVOX_CORE_LATTICE_LATTICE_H_
