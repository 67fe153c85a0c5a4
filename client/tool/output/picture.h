// Pictures of voxel sets.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_PICTURE_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_PICTURE_H_

#include <array>
#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "client/mesh/up_axis.h"
#include "client/tool/output/voxel_scene.h"
#include "latvox/cancellation.h"
#include "latvox/types.h"

namespace latvox::client {

struct PictureOptions {
  int side = 1024;                                 // pixels
  UpAxis up = UpAxis::kY;                          // of the world
  double azimuth = 30, elevation = 22;             // of the viewer, degrees: about `up`, from the next axis, and above
  std::array<uint8_t, 3> color = {118, 158, 210};  // of the surface, sRGB, unless the scene has colors
  Cancellation cancellation = {};                  // ends drawing within some rows
};

// How coarse a scene may be so that no picture shows it: the shift of a VoxelScene for a picture of `diagonal`, the
// length of what it shows in world units. Such a scene is of as many cells as the picture can tell, however many voxels
// there are.
int ShiftFor(const GridTransform& grid, double diagonal, const PictureOptions& options);

// The bytes of a PNG file: an orthographic view of the voxels' Voronoi cells, lit from above on the left, with shadows
// and with what is hollow darker. Cells that are large enough show facets and edges, smaller ones the shape that they
// make up. The bytes are the same for any number of threads. Memory: 60 bytes a pixel, 76 of a colored scene. Errors:
// CANCELLED, INTERNAL (libpng).
absl::StatusOr<std::string> DrawVoxels(const VoxelScene& scene, const PictureOptions& options);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_PICTURE_H_
