// Arrays with one element for every lattice point of a box.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_DENSE_OUTPUT_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_DENSE_OUTPUT_H_

#include <memory>
#include <vector>

#include "client/tool/output/atomic_file.h"
#include "client/tool/output/box_shape.h"
#include "client/tool/output/output.h"

namespace latvox::client {

// .npy: an array in C order over the smallest box of the voxels, as `shape` widens it. Element [i - i0, j - j0, k - k0]
// belongs to lattice point (i, j, k). Without a field it is uint8, 1 for a voxel, otherwise 0; with one, that field:
// see DenseFields. One of several components has a fourth axis; of links, it has one for each neighbor, and
// label_fractions one for each label. Without a voxel the array has shape (0, 0, 0). Memory: 88 bytes for each brick,
// and the field. Errors: RESOURCE_EXHAUSTED, before the first voxel, if the call's box has more than 2^32 bytes.
//   fields   at most one
std::unique_ptr<Output> NewDenseNpyOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields,
                                          const BoxShape& shape);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_DENSE_OUTPUT_H_
