// Formats for boxes of cubes.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_BOX_OUTPUT_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_BOX_OUTPUT_H_

#include <memory>

#include "client/tool/output/atomic_file.h"
#include "client/tool/output/box_shape.h"
#include "client/tool/output/output.h"

namespace latvox::client {

// The error for other lattices.
inline constexpr char kCubesOnly[] =
    "the format holds cubes along the axes only, those of --lattice cartesian with one --voxel-size";

// Returns whether the basis vectors are multiples of x, y and z, in this order and direction, up to the rounding of a
// scaled basis: the cells are boxes along the axes.
bool IsAlongAxes(const Basis& basis);

// Returns whether the cells are cubes along the world's axes, up to the rounding of a scaled basis.
bool IsCubic(const Basis& basis);

// .binvox, for a lattice of cubes along the world's axes: a cube of up to 4096 voxels a side (half a gigabyte if
// empty), starting at the lowest voxel. `translate` is the low corner of that voxel's cube, `scale` the side of the
// whole cube. So the centers of the cells are the world positions of the voxels. The shape is around the box of the
// voxels. Memory: 80 bytes for each brick, and a bit for each cell of a slice. Errors: INVALID_ARGUMENT for another
// lattice; RESOURCE_EXHAUSTED for a box that the format cannot hold, as soon as its voxels have come.
std::unique_ptr<Output> NewBinvoxOutput(std::unique_ptr<AtomicFile> file, const BoxShape& shape);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_BOX_OUTPUT_H_
