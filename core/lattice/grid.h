// A lattice at a place in the world.
#ifndef LATVOX_CORE_LATTICE_GRID_H_
#define LATVOX_CORE_LATTICE_GRID_H_

#include "core/base/vec.h"
#include "core/lattice/lattice.h"

namespace latvox {

// The positions of lattice points in the world: world = origin + V * ijk.
template <size_t D>
struct BasicGrid {
  BasicLattice<D> lattice;
  Vec<double, D> origin;
};
using Grid = BasicGrid<3>;
using PlaneGrid = BasicGrid<2>;

}  // namespace latvox

#endif  // LATVOX_CORE_LATTICE_GRID_H_
