// Common lattices with a separate scale along each axis of the world.
#ifndef LATVOX_LATVOX_STRETCHED_H_
#define LATVOX_LATVOX_STRETCHED_H_

#include "latvox/export.h"
#include "latvox/types.h"

namespace latvox::client {

// Returns the basis of a common lattice of voxel size 1, stretched along x, y and z by these factors, which must be
// above 0. On kCartesian they are the spacings of the voxels. A voxel's volume is their product on every lattice. With
// three equal factors, the result is the lattice itself at that voxel size.
//
// Neighbors, and so the meaning of a separability, follow from the Voronoi cells of the stretched lattice. On
// kCartesian they stay the same. On other lattices they change where the factors differ enough.
LATVOX_EXPORT Basis Stretched(NamedLattice lattice, const Vec3d& factors);

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_STRETCHED_H_
