#include "latvox/stretched.h"

#include "client/internal/voxel_size.h"

namespace latvox::client {

Basis Stretched(NamedLattice lattice, const Vec3d& factors) {
  Basis basis = kNamedLattices[static_cast<size_t>(lattice)].basis;
  const double side = VoxelSizeOf(basis);
  for (Vec3d* vector : {&basis.a, &basis.b, &basis.c}) {
    for (size_t axis = 0; axis < 3; ++axis) (*vector)[axis] *= factors[axis] / side;
  }
  return basis;
}

}  // namespace latvox::client
