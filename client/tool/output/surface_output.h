// Surfaces of voxel sets.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_SURFACE_OUTPUT_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_SURFACE_OUTPUT_H_

#include <memory>
#include <vector>

#include "client/tool/output/atomic_file.h"
#include "client/tool/output/output.h"

namespace latvox::client {

// .glb (binary glTF 2.0): the facets of Voronoi cells between a voxel and a lattice point that is not one, a closed
// surface. Positions are floats relative to a voxel, whose position is the translation of the node. There are no
// normals, which makes viewers show facets flat. With fields, corners have the colors of
// client/tool/output/voxel_colors.h, made linear. Memory: 2 bytes for each voxel, 4 more with colors, and some 160 for
// each brick. Errors: RESOURCE_EXHAUSTED over the 4 GiB of a .glb.
std::unique_ptr<Output> NewGlbOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_SURFACE_OUTPUT_H_
