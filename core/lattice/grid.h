// A lattice put somewhere in the world.
#ifndef LATVOX_CORE_LATTICE_GRID_H_
#define LATVOX_CORE_LATTICE_GRID_H_

#include "core/base/vec.h"
#include "core/lattice/lattice.h"

namespace latvox {

// Where lattice points lie in the world: world = origin + V * ijk.
struct Grid {
  Lattice lattice;
  Vec3d origin;
};

}  // namespace latvox

#endif  // LATVOX_CORE_LATTICE_GRID_H_
