// The thesis's numbering of BCC lattice points and its fair resolution (section 5.2, figure 5.6, eq. 5.2).
#ifndef LATVOX_CORE_VERIFY_BCC_INDEXING_H_
#define LATVOX_CORE_VERIFY_BCC_INDEXING_H_

#include <cmath>

#include "core/base/vec.h"

namespace latvox {

// BCC as two Cartesian lattices, half a step apart in every axis, with layers that alternate along the last index. A
// cube of D^3 unit cells is the array D x D x 2D. Index (x, y, z) is the point (2x + o, 2y + o, z), o = z mod 2, of the
// lattice with basis (2,0,0) (0,2,0) (1,1,1), in units of half a unit cell's edge.
//
// A point's last lattice coordinate is its height z. Each step of it moves by (1, 1) in the plane, which is half an
// index in x and y; o keeps the half.
constexpr Vec3i BccToLattice(const Vec3i& index) {
  const int32_t unit_cells = index[2] >> 1;
  return {index[0] - unit_cells, index[1] - unit_cells, index[2]};
}

// The inverse.
constexpr Vec3i LatticeToBcc(const Vec3i& ijk) {
  const int32_t unit_cells = ijk[2] >> 1;
  return {ijk[0] + unit_cells, ijk[1] + unit_cells, ijk[2]};
}

// Eq. 5.2: 2 D_BCC^3 = D_CC^3, equally many lattice points in one volume. Not rounded: 256 and 203.2.
inline double FairBccResolution(double cartesian) { return cartesian / std::cbrt(2.0); }
inline double FairCartesianResolution(double bcc) { return bcc * std::cbrt(2.0); }

}  // namespace latvox

#endif  // LATVOX_CORE_VERIFY_BCC_INDEXING_H_
