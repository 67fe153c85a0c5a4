// How far voxels reach.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_VOXEL_FRONT_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_VOXEL_FRONT_H_

#include <array>
#include <vector>

#include "client/tool/output/voxel_scene.h"
#include "latvox/types.h"

namespace latvox::client {

// The voxels of a scene as seen from one direction: a bound on how near they come, found brick by brick, so that rays
// of that direction need not be cast where nothing is. All in the scene's frame.
class VoxelFront {
 public:
  VoxelFront(const VoxelScene& scene, const Vec3d& towards);  // unit length

  // No cell meets point + t * towards for a t above this; minus infinity: for any t.
  double Reach(const Vec3d& point) const;

 private:
  // Across, in squares of the plane; along `towards`.
  Vec3d Project(const Vec3d& point) const;
  size_t Square(int x, int y) const;  // in front_

  Vec3d u_, v_, towards_;
  std::array<int, 2> low_{}, size_{};  // squares
  std::vector<float> front_;           // of each square
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_VOXEL_FRONT_H_
