// The heads of files of images in space: NRRD, MetaImage, NIfTI.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_IMAGE_HEADER_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_IMAGE_HEADER_H_

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "latvox/types.h"

namespace latvox::client {

// An array over a box of lattice points, i fastest.
struct ImageFacts {
  Basis basis;                         // steps along i, j, k
  Vec3d corner;                        // world position of the first element
  std::array<uint64_t, 3> shape = {};  // along i, j, k; each at least 1
  NumberType type;                     // of a component; kUint32 stands for int32
  size_t components = 1;
  std::string name;                        // of the field, of the fields with commas between them, or "data"
  std::vector<std::string> segments = {};  // names of labels 1, 2 and so on; "": unknown
  bool is_list = false;                    // the components are not those of a vector
  std::vector<Vec3i> neighbors = {};       // of fields of links: the lattice vectors of their components
};

// NRRD0005, up to the empty line; the data follow in gzip. `space directions` are the basis. The space is
// left-posterior-superior, because ITK and Slicer take positions in meshes for that: so mesh and voxels lie on each
// other. Components come first among the axes. Names of labels are the keys of 3D Slicer's segmentations. Lattice
// vectors of neighbors are the key `neighbors`.
std::string NrrdHeader(const ImageFacts& image);

// MetaImage. Rows of TransformMatrix are the unit vectors of the basis, ElementSpacing are their lengths. ITK takes
// positions for left-posterior-superior, too.
// Lattice vectors of neighbors are in the comment.
//   compressed_bytes   length of the zlib stream that follows; the header's length does not depend on it
std::string MetaImageHeader(const ImageFacts& image, uint64_t compressed_bytes);

// The same for data as they are, in another file.
std::string MetaImageHeader(const ImageFacts& image, const std::string& data_file);

// Returns whether NIfTI-1 cannot hold the image: a side exceeds 32767 elements, or the floats of its sform move a
// corner of the box by more than a thousandth of the shortest step.
bool NeedsNifti2(const ImageFacts& image);

// NIfTI-1 of one file, 352 bytes; if NeedsNifti2, NIfTI-2, 544 bytes. sform is the basis, in floats or doubles; its
// code says "aligned to another file", the mesh. There is no qform, because a quaternion knows only right angles. The
// header is written by hand, because it is a dozen numbers at fixed places. Debian's libnifti2 opens a file by its name
// and compresses by itself. So a file could neither be an AtomicFile nor be compressed by several threads.
// Colors are RGB24; other components are the fifth dimension, so that all elements of one component come before those
// of the next.
std::string NiftiHeader(const ImageFacts& image);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_IMAGE_HEADER_H_
