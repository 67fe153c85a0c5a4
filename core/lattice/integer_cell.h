// The Voronoi cell of a lattice, in integers.
//
// Let b_0 .. b_3 be an obtuse superbase (Selling) and p_r = -b_i.b_j >= 0 for its six pairs r = (i, j). With the
// covectors e_r that take the difference of the superbase coordinates i and j, the lattice's quadratic form is
//   |V x|^2 = x.G x,   G = sum_r p_r e_r e_r^T
// and the e_r are unimodular: any three of them have determinant 0 or +-1. Then the cell is a zonotope, and simple in
// the coordinates y = G x [Erdahl, Zonotopes, dicings, and Voronoi's conjecture on parallelohedra, 1999]:
//   G * cell = { sum_r s_r p_r e_r : |s_r| <= 1/2 }
// So the six numbers p_r determine the cell linearly, and they may be scaled at will.
#ifndef LATVOX_CORE_LATTICE_INTEGER_CELL_H_
#define LATVOX_CORE_LATTICE_INTEGER_CELL_H_

#include <cstdint>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/vec.h"
#include "core/lattice/lattice.h"

namespace latvox {

// Bounds on cells; the bit widths in core/supercover/supercover.h depend on them.
inline constexpr int kZoneBits = 30;      // a zone's length is at most 2^kZoneBits
inline constexpr int kMaxZoneEntry = 8;   // sum of absolute entries of e_r
inline constexpr size_t kMaxZones = 6;    // p_r > 0
inline constexpr size_t kMaxFacets = 14;  // both of each pair

// One p_r > 0.
struct CellZone {
  Vec3i e;
  int64_t length;
};

// The cell as a sum of segments: { sum_r s_r step_r / parts : |s_r| <= 1/2 }, in lattice coordinates.
struct CellSegments {
  std::vector<Vec3i> steps;  // one for each zone, along edges of the cell; no two are parallel
  int32_t parts;
};

// The only rounding. The six p_r become the smallest integers, at most 1024, that have their ratios within
// kSymmetryTolerance of the largest. Where there are no such integers, they become multiples of 2^-30 of the largest.
// So the named lattices, and those with a basis of small integers, are exact. Another lattice is replaced by one that
// differs from it by no more than that: its cells still fill space without gaps or overlaps. Lengths that Lattice
// counts as equal are equal here, so its neighbors' cells meet the cell.
class IntegerCell {
 public:
  // Errors: INVALID_ARGUMENT if the lattice is too skewed for kMaxZoneEntry, or so flat or long that this rounding
  // would matter: its shortest vector is below about 1/512 of its longest superbase vector.
  static absl::StatusOr<IntegerCell> Of(const Lattice& lattice);

  const std::vector<CellZone>& zones() const { return zones_; }
  const Mat<int64_t, 3>& form() const { return form_; }         // G, symmetric
  const std::vector<Vec3i>& facets() const { return facets_; }  // one of each pair +-w of neighbors across a facet
  int length_bits() const { return length_bits_; }              // every length is at most 2^length_bits

  // Returns the smallest integers for it, or nullopt if one exceeds `most`.
  std::optional<CellSegments> Segments(int32_t most) const;

  // Returns the largest value of `covector` . x over the cell, times `scale`, rounded down. Precondition: the
  // covector's entries are below 2^52, and scale is at most 2^8.
  __int128 Support(const Vec<int64_t, 3>& covector, int32_t scale) const;

 private:
  IntegerCell() = default;
  void SetZones(std::vector<CellZone> zones);

  std::vector<CellZone> zones_;
  Mat<int64_t, 3> form_{};
  std::vector<Vec3i> facets_;
  int length_bits_ = 0;
  std::vector<Vec<__int128, 3>> directions_;  // adjugate of G times e_r: along the edges of the cell
  __int128 determinant_ = 0;                  // of G
};

}  // namespace latvox

#endif  // LATVOX_CORE_LATTICE_INTEGER_CELL_H_
