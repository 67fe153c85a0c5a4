// Pages that show voxels in a browser.
#ifndef LATVOX_CLIENT_TOOL_VIEW_PAGE_H_
#define LATVOX_CLIENT_TOOL_VIEW_PAGE_H_

#include <string>

#include "absl/status/statusor.h"
#include "latvox/grid/grid_content.h"
#include "latvox/mesh_files/up_axis.h"

namespace latvox::client {

inline constexpr uint64_t kMaxPageVoxels = 4'000'000;

// Returns one HTML page that needs nothing else: the scripts of this folder, the library three, and the voxels of the
// file:
//
//   data     JSON, see below
//   bricks   base64: brick_ijk and mask of each brick, 76 bytes, little-endian
//   colors   base64: for each of the paints, red, green and blue of each voxel
//   values   base64: for each of the paints with uint32 or float32, the value of each voxel, 4 bytes a component
//
// Fields of the JSON:
//
//   title, metadata   of the file
//   voxels            their number
//   low, high         the voxels' box, half-open
//   grid              origin and basis: where lattice points are in the world
//   basis, middle     a voxel is drawn at basis * (ijk - low - middle); the shape lies within 1 of 0, and y is up
//   axes              directions of the world's axes in this frame
//   facets            of a cell: normal, corners relative to its center, and step to the neighbor behind it
//   paints            choices of colors: name, legend, whether the legend is a ramp, type of the values, and their
//                     components; the first is the default. Types: rgb (the colors themselves), none, uint32, float32
//   band              whether these are the voxels of a band
//
// Errors: RESOURCE_EXHAUSTED:
//   - more voxels than kMaxPageVoxels, or farther apart than 65536
//   - more colors than kMaxPageColors of paints.h
//   - a basis so skewed that a step to a neighbor is more than 8 along an axis
absl::StatusOr<std::string> ViewPage(const GridContent& content, const std::string& title, UpAxis up);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_VIEW_PAGE_H_
