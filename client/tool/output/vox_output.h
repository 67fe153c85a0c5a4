// MagicaVoxel's files.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_VOX_OUTPUT_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_VOX_OUTPUT_H_

#include <memory>
#include <vector>

#include "client/tool/output/atomic_file.h"
#include "client/tool/output/output.h"

namespace latvox::client {

// .vox, version 150, for a lattice of cubes along the world's axes; z is up; without world positions. A box of up to
// 256 voxels a side is one model. A larger one is a scene of models of up to 256, without empty ones; its low corner is
// at z = 0, its middle at x = y = 0. With fields, a palette has the colors of client/tool/output/voxel_colors.h: exact
// up to 255, then reduced. Each part or material has an entry of its own, in ascending order, if they are up to 255;
// otherwise each of their twelve colors has one. Without colors, voxels have the first color of the program's palette.
// Memory: 80 bytes for each brick; with colors 4 bytes for each voxel; and the largest model. Errors: INVALID_ARGUMENT
// for another lattice; RESOURCE_EXHAUSTED for more than 4 GiB.
std::unique_ptr<Output> NewVoxOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_VOX_OUTPUT_H_
