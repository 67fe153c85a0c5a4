// Three-dimensional lattices: bases, neighbours, scan directions.
//
// A lattice is { V*ijk : ijk in Z^3 }; the columns of the sampling matrix V are its basis vectors (thesis section 2.1).
#ifndef LATVOX_CORE_LATTICE_LATTICE_H_
#define LATVOX_CORE_LATTICE_LATTICE_H_

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/vec.h"
#include "core/lattice/frame.h"
#include "core/lattice/neighbors.h"

namespace latvox {

enum class NamedLattice { kCartesian, kBcc, kFcc, kHexagonal };

class Lattice {
 public:
  // The named lattice, scaled so that voxel_size() is 1. Columns up to scale:
  //   kCartesian   (1,0,0) (0,1,0) (0,0,1)
  //   kBcc         (2,0,0) (0,2,0) (1,1,1)       thesis eq. 4.3
  //   kFcc         (1,1,0) (1,0,1) (0,1,1)
  //   kHexagonal   (1,0,0) (1/2,sqrt(3)/2,0) (0,0,1)
  static Lattice Named(NamedLattice name);

  // The lattice with columns V, world units. Errors: INVALID_ARGUMENT if an entry is not finite, if V is singular, or
  // if it is too skew, which is to say that a frame needs a row with an absolute sum over kMaxFrameRow; the message
  // then gives a basis of the same lattice that is not.
  static absl::StatusOr<Lattice> FromBasis(const Mat3d& basis);

  // The same lattice scaled uniformly to voxel_size. Precondition: voxel_size is finite and > 0.
  absl::StatusOr<Lattice> Scaled(double voxel_size) const;

  const Mat3d& basis() const { return basis_; }      // V, world units
  const Mat3d& inverse() const { return inverse_; }  // V^-1, by columns

  // "cartesian", "bcc", "fcc" or "hexagonal"; "stretched-" and one of these, of a basis that is theirs but for other
  // scales along the axes; or "basis". Named within kSymmetryTolerance, and by the basis as it stands: another one of
  // the same lattice, or a turned one, is "basis".
  std::string_view name() const { return name_; }

  double voxel_size() const;  // |det V|^(1/3): edge of a cube with a cell's volume, eq. 5.2

  // Every lattice vector whose Voronoi cell meets the origin's, with the dimension of the shared face.
  const std::vector<Neighbor<3>>& neighbors() const { return neighbors_; }

  // The frames of one of each pair +-q of k-neighbours, in lexicographic order of q; q's first nonzero entry is
  // positive. k in 0, 1, 2.
  const std::vector<Frame>& frames(int k) const { return frames_[static_cast<size_t>(k)]; }

 private:
  Lattice(std::string_view name, const Mat3d& basis, const Mat3d& inverse)
      : name_(name), basis_(basis), inverse_(inverse) {}
  static absl::StatusOr<Lattice> Make(std::string_view name, const Mat3d& basis);

  std::string_view name_;
  Mat3d basis_, inverse_;
  std::vector<Neighbor<3>> neighbors_;
  std::array<std::vector<Frame>, 3> frames_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_LATTICE_LATTICE_H_
