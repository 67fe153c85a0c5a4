// Scenes for pictures of a result.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_PICTURE_SCENE_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_PICTURE_SCENE_H_

#include <cstdint>
#include <span>
#include <vector>

#include "client/tool/output/voxel_scene.h"
#include "latvox/types.h"

namespace latvox::client {

// Returns the distance within which voxels of a band represent the surface, world units. It is half of the longest step
// between cells that share a facet. Where such a step crosses the surface, one of its ends is that near, so no line of
// sight passes through.
double SkinDepth(const GridTransform& grid);

// Returns the voxels of a batch with distances that are at most `depth` outside: the surface, and the inside if
// distances are signed. Omits bricks without such voxels.
//   colors   one for each voxel of the batch, or none; keeps those of the voxels returned
std::vector<Brick> SkinOf(const BrickBatch& batch, double depth, std::vector<uint32_t>& colors);

// Returns the diagonal of the box of lattice points, in world units; 0 without bricks.
double DiagonalOf(std::span<const Brick> bricks, const GridTransform& grid);

// Adds the bricks with the colors of all their voxels, or without colors.
void AddBricks(std::span<const Brick> bricks, std::span<const uint32_t> colors, VoxelScene& scene);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_PICTURE_SCENE_H_
