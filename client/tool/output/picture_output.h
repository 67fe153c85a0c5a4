// The output .png.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_PICTURE_OUTPUT_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_PICTURE_OUTPUT_H_

#include <memory>

#include "client/tool/output/atomic_file.h"
#include "client/tool/output/output.h"
#include "latvox/mesh_files/up_axis.h"

namespace latvox::client {

// Draws the voxels in their own colors, if they have any, otherwise by their other values. For a band draws the skin:
// see client/tool/output/picture_scene.h.
std::unique_ptr<Output> NewPictureOutput(std::unique_ptr<AtomicFile> file, const VoxelizeRequest& request, UpAxis up);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_PICTURE_OUTPUT_H_
