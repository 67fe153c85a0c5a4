// The thesis's voxelization matrix (section 4.3.1, tables 4.1-4.4), for every lattice and direction.
#ifndef LATVOX_CORE_THESIS_VOXELIZATION_MATRIX_H_
#define LATVOX_CORE_THESIS_VOXELIZATION_MATRIX_H_

#include "core/base/vec.h"
#include "core/lattice/lattice.h"

namespace latvox {

// M = V*N, by columns:
//   m   world units: two base-plane directions and, last, the principal direction (eq. 4.1)
//   n   the same in lattice coordinates, V^-1 * M
// (1) |det N| = 1: the columns of M span the lattice   (2) the last column of N is frame.q
//
// The thesis finds M by exhaustive search and lists it in tables. Here N is the frame's U, found for any lattice. M is
// not unique, so the thesis's tables and these differ; both are valid.
struct VoxelizationMatrix {
  Mat3d m;
  Mat<int32_t, 3> n;
};

VoxelizationMatrix MakeVoxelizationMatrix(const Lattice& lattice, const Frame& frame);

}  // namespace latvox

#endif  // LATVOX_CORE_THESIS_VOXELIZATION_MATRIX_H_
