// What pictures show of a result.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_PICTURE_SCENE_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_PICTURE_SCENE_H_

#include <cstdint>
#include <span>
#include <vector>

#include "client/tool/output/voxel_scene.h"
#include "latvox/types.h"

namespace latvox::client {

// How near to the surface the voxels of a band are that stand for it, world units: half of the longest step between
// cells that share a facet. Where such a step meets the surface, one of its ends is as near, so that no line of sight
// passes through.
double SkinDepth(const GridTransform& grid);

// Of a band's batch, the voxels that are no farther outside than `depth`: the surface, and what of a signed band is
// inside. Bricks that have none are left out.
std::vector<Brick> SkinOf(const BrickBatch& batch, double depth);

// Adds the bricks, with the colors of all their voxels, or none.
void AddBricks(std::span<const Brick> bricks, std::span<const uint32_t> colors, VoxelScene& scene);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_PICTURE_SCENE_H_
