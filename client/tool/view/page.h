// Pages that show voxels in a browser.
#ifndef LATVOX_CLIENT_TOOL_VIEW_PAGE_H_
#define LATVOX_CLIENT_TOOL_VIEW_PAGE_H_

#include <string>

#include "absl/status/statusor.h"
#include "client/mesh/up_axis.h"
#include "latvox/grid/grid_content.h"

namespace latvox::client {

inline constexpr uint64_t kMaxPageVoxels = 4'000'000;

// One HTML page that needs nothing else: the scripts of this folder, the library three, and the file's voxels:
//
//   data    JSON: title; metadata; low, high: the voxels' box, half-open; basis and middle: where a voxel is drawn,
//           basis * (ijk - low - middle), the shape being within 1 of 0, and y up; axes: where the world's are, then;
//           facets: of a cell, with normal, corners about its centre, and the step to the neighbour behind it
//           paints: what voxels may be colored by: name, legend, whether that is a ramp; the first is the default;
//           band: whether these are the voxels of one
//   bricks  base64: brick_ijk and mask of each, 76 bytes, little-endian
//   colors  base64: for each of the paints, red, green and blue of each voxel
//
// Errors: RESOURCE_EXHAUSTED: more voxels than kMaxPageVoxels, or farther apart than 65536; a basis so skew that a step
// to a neighbour is more than 8 along an axis.
absl::StatusOr<std::string> ViewPage(const GridContent& content, const std::string& title, UpAxis up);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_VIEW_PAGE_H_
