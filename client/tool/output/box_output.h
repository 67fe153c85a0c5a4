// Formats of dense boxes of cubes.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_BOX_OUTPUT_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_BOX_OUTPUT_H_

#include <memory>

#include "client/tool/output/atomic_file.h"
#include "client/tool/output/output.h"

namespace latvox::client {

// What is wrong with another lattice.
inline constexpr char kCubesOnly[] =
    "the format holds cubes along the axes only; use --lattice cartesian and one --voxel-size";

// Whether the cells are cubes along the world's axes, but for what rounding does to a scaled basis.
bool IsCubic(const Basis& basis);

// Both need a lattice of cubes along the world's axes. Memory grows with the voxels, not with the box. Errors:
// INVALID_ARGUMENT for another lattice; RESOURCE_EXHAUSTED for a box that the format cannot hold.
//   .binvox   a cube of up to 4096 voxels a side (half a gigabyte, were it empty) from the lowest voxel on; `translate`
//             is the low corner of that voxel's cube, `scale` the whole cube's side, so that cells' centres are the
//             voxels' world positions
//   .vox      MagicaVoxel: up to 256 voxels a side, z up, without world positions
std::unique_ptr<Output> NewBinvoxOutput(std::unique_ptr<AtomicFile> file);
std::unique_ptr<Output> NewVoxOutput(std::unique_ptr<AtomicFile> file);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_BOX_OUTPUT_H_
