// Common lattices with a scale of their own along each axis of the world.
#ifndef LATVOX_LATVOX_STRETCHED_H_
#define LATVOX_LATVOX_STRETCHED_H_

#include "latvox/export.h"
#include "latvox/types.h"

namespace latvox::client {

// The basis of a common lattice of voxel size 1, stretched along x, y and z by these factors, which must be above 0. On
// kCartesian they are the spacings of the voxels; a voxel's volume is their product on every lattice. With three equal
// ones it is the lattice itself at that voxel size.
//
// Neighbours, and with them what a separability means, are those of the Voronoi cells of the stretched lattice: on
// kCartesian the same as ever, elsewhere other ones where the factors differ enough.
LATVOX_EXPORT Basis Stretched(NamedLattice lattice, const Vec3d& factors);

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_STRETCHED_H_
