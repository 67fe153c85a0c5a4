// Surfaces of voxel sets.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_SURFACE_OUTPUT_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_SURFACE_OUTPUT_H_

#include <memory>

#include "client/tool/output/atomic_file.h"
#include "client/tool/output/output.h"

namespace latvox::client {

// .glb (binary glTF 2.0): the facets of the voxels' Voronoi cells between a voxel and a lattice point that is none, a
// closed surface. Positions are floats about a voxel, whose place is the node's translation; no normals, which asks
// viewers to show facets flat. If voxels carry attributes, these are colors alone, and corners have them. Memory grows
// with the voxels. Errors: RESOURCE_EXHAUSTED over .glb's 4 GiB.
std::unique_ptr<Output> NewGlbOutput(std::unique_ptr<AtomicFile> file);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_SURFACE_OUTPUT_H_
