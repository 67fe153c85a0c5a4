// Pictures of voxel sets.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_PICTURE_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_PICTURE_H_

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "client/tool/output/picture_style.h"
#include "client/tool/output/voxel_scene.h"
#include "latvox/cancellation.h"
#include "latvox/mesh_files/up_axis.h"
#include "latvox/types.h"

namespace latvox::client {

struct PictureOptions {
  int side = 1024;                      // pixels; of a picture that is cropped, the longer side
  UpAxis up = UpAxis::kY;               // of the world
  double azimuth = 30, elevation = 22;  // of the viewer, degrees: about `up`, from the next axis, and height
  Rgb8 color = {118, 158, 210};         // of the surface if the scene has no colors, sRGB
  bool crop = false;                    // whether the picture ends near the voxels
  PictureStyle style = {};
  Cancellation cancellation = {};  // stops drawing within a few tiles
};

// Returns the least shift of a VoxelScene that is as fine as a picture can show. `diagonal` is the length of the scene
// in world units. Such a scene has only as many cells as the picture can resolve, for any number of voxels.
int ShiftFor(const GridTransform& grid, double diagonal, const PictureOptions& options);

// Returns the bytes of a PNG file: an orthographic view of the voxels' Voronoi cells, lit from above on the left, with
// shadows and darker hollows. Large cells show facets and edges, small ones the shape that they form. A legend is
// below. The bytes do not depend on the number of threads.
// Memory: 60 bytes per pixel, 76 for a colored scene. Errors: CANCELLED, INTERNAL (libpng).
absl::StatusOr<std::string> DrawVoxels(const VoxelScene& scene, const PictureOptions& options);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_PICTURE_H_
