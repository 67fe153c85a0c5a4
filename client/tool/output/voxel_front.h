// The front of a set of voxels.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_VOXEL_FRONT_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_VOXEL_FRONT_H_

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "client/internal/vec3.h"
#include "client/tool/output/voxel_scene.h"
#include "latvox/types.h"

namespace latvox::client {

// The voxels of a scene as seen from one direction: an upper bound of their height, found brick by brick. So rays of
// that direction can skip empty space. Everything is in the frame of the scene.
class VoxelFront {
 public:
  VoxelFront(const VoxelScene& scene, const Vec3d& towards);  // unit length

  // Returns a bound t: no cell meets point + s * towards for s > t. Minus infinity: no cell on the whole line.
  double Reach(const Vec3d& point) const {
    const Vec3d at = Project(point);
    for (size_t m = 0; m < 2; ++m) {
      if (!(at[m] >= low_[m] && at[m] < low_[m] + size_[m])) return kNothing;
    }
    return front_[Square(Floor(at[0]), Floor(at[1]))] - at[2];
  }

 private:
  // Returns the position: two coordinates in squares of the plane, and the height along `towards`.
  Vec3d Project(const Vec3d& point) const {
    return {Dot(point, u_) / kSquare, Dot(point, v_) / kSquare, Dot(point, towards_)};
  }

  size_t Square(int x, int y) const {  // index in front_
    return static_cast<size_t>(y - low_[1]) * static_cast<size_t>(size_[0]) + static_cast<size_t>(x - low_[0]);
  }

  static int Floor(double x) { return static_cast<int>(std::floor(x)); }

  static constexpr double kSquare = 2;  // edge
  static constexpr float kNothing = -std::numeric_limits<float>::infinity();

  Vec3d u_, v_, towards_;
  std::array<int, 2> low_{}, size_{};  // squares
  std::vector<float> front_;           // of each square
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_VOXEL_FRONT_H_
