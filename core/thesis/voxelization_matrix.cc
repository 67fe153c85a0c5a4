#include "core/thesis/voxelization_matrix.h"

namespace latvox {

VoxelizationMatrix MakeVoxelizationMatrix(const Lattice& lattice, const Frame& frame) {
  VoxelizationMatrix matrix{{}, frame.u};
  for (size_t c = 0; c < 3; ++c) matrix.m[c] = Apply(lattice.basis(), frame.u[c]);
  return matrix;
}

}  // namespace latvox
