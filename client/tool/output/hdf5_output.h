// Voxels as HDF5.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_HDF5_OUTPUT_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_HDF5_OUTPUT_H_

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "client/tool/output/atomic_file.h"
#include "client/tool/output/output.h"

namespace latvox::client {

// .h5: one row for each voxel, in the order of the stream. Arrays grow by chunks, which are compressed.
//   /                       attributes `format` "latvox", `format_version` 1, `lattice`, `set`, `voxel_size`, `basis`
//                           (rows are the steps of i, j and k), `origin`, and with voxels `index_box` (lowest point,
//                           highest point + 1); the metadata of a .vdb, as text, under their names: latvox_...
//   /sets/voxels/ijk        int32, n x 3
//   /sets/voxels/brick_ijk, brick_mask, brick_first
//                           int32, m x 3; uint64, m x 8; uint64, m: see Brick; the row of its first voxel
//   /fields/NAME            n, or n x components: types as in numpy, see NumpyTypeOf; those of label_fractions have the
//                           order of latvox_fraction_labels
//   /links                  with fields of links, one row for each crossed link:
//     neighbors             int32, K x 3: lattice vectors
//     voxel, neighbor       uint64, L: row of its voxel; uint8, L: row of `neighbors`
//     ijk                   int32, L x 3: lattice coordinates of its voxel
//     share, triangle, crossings   float32, int32, int32, L: one for each of the fields
// Memory: less than 2 MB for each array. Errors: FAILED_PRECONDITION: see Hdf5::Load.
//   metadata   nothing: those of request, note and summary
std::unique_ptr<Output> NewHdf5Output(std::unique_ptr<AtomicFile> file, const VoxelizeRequest& request,
                                      const OutputOptions& options);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_HDF5_OUTPUT_H_
