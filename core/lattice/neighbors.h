// The neighbors of a lattice point, from the basis alone, for every lattice in two and three dimensions.
#ifndef LATVOX_CORE_LATTICE_NEIGHBORS_H_
#define LATVOX_CORE_LATTICE_NEIGHBORS_H_

#include <vector>

#include "absl/status/statusor.h"
#include "core/base/vec.h"

namespace latvox {

// Lengths within this relative difference count as equal, because a symmetric lattice is rarely exact in doubles. Where
// it matters, the error adds neighbors, and raises the dimension of faces. That is safe for separation; a missing
// neighbor never is.
inline constexpr double kSymmetryTolerance = 1e-9;

template <size_t D>
struct Neighbor {
  Vec<int32_t, D> w;   // lattice coordinates
  int face_dimension;  // of the face that the Voronoi cells of 0 and w share: 0 .. D-1
  bool operator==(const Neighbor&) const = default;
};

// Returns a basis of the same lattice that belongs to an obtuse superbase (Selling), by its integer combinations:
// reduced = basis * transform. Errors: INVALID_ARGUMENT if an entry is not finite, or if the basis is singular, or so
// skewed that an entry of the transform would exceed 2^20.
template <size_t D>
absl::StatusOr<Mat<int32_t, D>> ReduceBasis(const Mat<double, D>& basis);

// Returns all lattice vectors w with a Voronoi cell that meets the cell of 0, with the dimension of the shared face.
//   (1) closed under negation   (2) no two in one parity class of ijk except those of equal length   (3) sorted by w
// N_k, the k-neighbors of thesis section 2.2, are those with face_dimension >= k. Errors: as ReduceBasis.
template <size_t D>
absl::StatusOr<std::vector<Neighbor<D>>> FindNeighbors(const Mat<double, D>& basis);

}  // namespace latvox

#endif  // LATVOX_CORE_LATTICE_NEIGHBORS_H_
