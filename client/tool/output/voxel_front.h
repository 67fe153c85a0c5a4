// The front of a set of voxels.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_VOXEL_FRONT_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_VOXEL_FRONT_H_

#include <array>
#include <vector>

#include "client/tool/output/voxel_scene.h"
#include "latvox/types.h"

namespace latvox::client {

// The voxels of a scene as seen from one direction: an upper bound of their height, found brick by brick. So rays of
// that direction can skip empty space. Everything is in the frame of the scene.
class VoxelFront {
 public:
  VoxelFront(const VoxelScene& scene, const Vec3d& towards);  // unit length

  // Returns a bound t: no cell meets point + s * towards for s > t. Minus infinity: no cell on the whole line.
  double Reach(const Vec3d& point) const;

 private:
  // Returns the position: two coordinates in squares of the plane, and the height along `towards`.
  Vec3d Project(const Vec3d& point) const;
  size_t Square(int x, int y) const;  // index in front_

  Vec3d u_, v_, towards_;
  std::array<int, 2> low_{}, size_{};  // squares
  std::vector<float> front_;           // of each square
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_VOXEL_FRONT_H_
