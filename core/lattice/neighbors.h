// The neighbors of a lattice point, from the basis alone, for every lattice in two and three dimensions.
#ifndef LATVOX_CORE_LATTICE_NEIGHBORS_H_
#define LATVOX_CORE_LATTICE_NEIGHBORS_H_

#include <vector>

#include "absl/status/statusor.h"
#include "core/base/vec.h"

namespace latvox {

// Lengths within this relative difference count as equal, since a symmetric lattice is rarely exact in doubles. Where
// it matters it errs towards more neighbors, and faces of higher dimension, which is safe for separation; missing one
// never is.
inline constexpr double kSymmetryTolerance = 1e-9;

template <size_t D>
struct Neighbor {
  Vec<int32_t, D> w;   // lattice coordinates
  int face_dimension;  // of the face that the Voronoi cells of 0 and w share: 0 .. D-1
  bool operator==(const Neighbor&) const = default;
};

// A basis of the same lattice that belongs to an obtuse superbase (Selling), given by its integer combinations:
// reduced = basis * transform. Errors: INVALID_ARGUMENT if an entry is not finite, the basis is singular, or so skew
// that an entry of the transform would exceed 2^20.
template <size_t D>
absl::StatusOr<Mat<int32_t, D>> ReduceBasis(const Mat<double, D>& basis);

// All lattice vectors w whose Voronoi cell meets the cell of 0, with the dimension of the shared face.
//   (1) closed under negation   (2) no two in one parity class of ijk but those of equal length   (3) sorted by w
// N_k, the k-neighbors of thesis section 2.2, are those with face_dimension >= k.
// Errors: as ReduceBasis.
template <size_t D>
absl::StatusOr<std::vector<Neighbor<D>>> FindNeighbors(const Mat<double, D>& basis);

}  // namespace latvox

#endif  // LATVOX_CORE_LATTICE_NEIGHBORS_H_
