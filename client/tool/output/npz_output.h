// Dense arrays with their place in the world.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_NPZ_OUTPUT_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_NPZ_OUTPUT_H_

#include <memory>
#include <vector>

#include "client/tool/output/atomic_file.h"
#include "client/tool/output/box_shape.h"
#include "client/tool/output/output.h"

namespace latvox::client {

// .npz: a zip archive of .npy members, as numpy.load reads it. (i0, j0, k0) is the low corner of the smallest box of
// the voxels, as `shape` widens it.
//   data        C order, shape of that box, (0, 0, 0) without a voxel. Element [i - i0, j - j0, k - k0] belongs to
//               lattice point (i, j, k): uint8, 1 for a voxel, otherwise 0
//   part, color, ...   one for each field, of the same shape, and of its components: see DenseFields
//   ijk         int32 (n, 3): lattice coordinates of the voxels, in the order of the stream
//   links, ...  fields of links: one row for each row of ijk, because other points of the box would be most of the file
//   neighbors   int32 (K, 3), with these: lattice vectors of their columns
//   index_min   int32 (3): i0, j0, k0
//   affine      float64 (4, 4): affine @ (a, b, c, 1) is the world position of element [a, b, c], the center of a voxel
//   basis       float64 (3, 3): basis[n] is the world vector of one step along index n
//   origin      float64 (3): world position of lattice point (0, 0, 0)
// Memory: 164 bytes for each brick, and the fields. Errors: RESOURCE_EXHAUSTED, before the first voxel, if the call's
// box makes an array of more than 2^32 bytes.
std::unique_ptr<Output> NewNpzOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields,
                                     const BoxShape& shape);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_NPZ_OUTPUT_H_
