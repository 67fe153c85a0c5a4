// Arrays with one element for every lattice point of a box.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_DENSE_OUTPUT_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_DENSE_OUTPUT_H_

#include <memory>

#include "client/tool/output/atomic_file.h"
#include "client/tool/output/output.h"

namespace latvox::client {

// .npy: a uint8 array in C order. Element [i - i0, j - j0, k - k0] is 1 if (i, j, k) is a voxel, otherwise 0. i0 <= i <
// i1 and so on is the index box of the call (Accepted::index_box); without one the array has shape (0, 0, 0).
// Memory: 88 bytes for each brick. Errors: RESOURCE_EXHAUSTED for more than 2^32 elements, before the first voxel.
std::unique_ptr<Output> NewDenseNpyOutput(std::unique_ptr<AtomicFile> file);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_DENSE_OUTPUT_H_
