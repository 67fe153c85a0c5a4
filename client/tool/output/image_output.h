// Images in space, as ITK, Slicer and readers of medical images take them.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_IMAGE_OUTPUT_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_IMAGE_OUTPUT_H_

#include <memory>
#include <vector>

#include "client/tool/output/atomic_file.h"
#include "client/tool/output/box_shape.h"
#include "client/tool/output/output.h"

namespace latvox::client {

enum class ImageFormat {
  kNrrd,       // .nrrd, gzip
  kMetaImage,  // .mha, zlib
  kMetaPair,   // .mhd with the data in a .raw beside it, not compressed
  kNifti,      // .nii
  kNiftiGzip,  // .nii.gz
};

// One array over the box of the call, i fastest: `data` without fields, otherwise DenseFields::Joined. Parts, materials
// and triangles are one more than there, and 0 where there is no voxel: programs for images take 0 for the background.
// Crossings of links are 0 there, too. The place in the world is exact for every lattice; in NIfTI-1, up to a
// thousandth of a voxel. Without a box, the array is one empty element at lattice point 0, because the formats have no
// empty arrays. A .mhd and its .raw appear one after the other, first the .raw: a kill in between leaves an older .mhd
// with new data. Memory: 88 bytes for each brick, and the fields. Errors: RESOURCE_EXHAUSTED for an array of more than
// 2^32 bytes, before the first voxel; INVALID_ARGUMENT for the name of a .mhd with control characters.
//   fields   of one type of numbers; of NIfTI at most one
std::unique_ptr<Output> NewImageOutput(std::unique_ptr<AtomicFile> file, ImageFormat format,
                                       const std::vector<Field>& fields, const BoxShape& shape);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_IMAGE_OUTPUT_H_
