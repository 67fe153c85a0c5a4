// The front of a set of voxels.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_VOXEL_FRONT_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_VOXEL_FRONT_H_

#include <array>
#include <limits>
#include <span>
#include <vector>

#include "client/internal/vec3.h"
#include "client/tool/output/voxel_scene.h"
#include "latvox/cancellation.h"
#include "latvox/types.h"

namespace latvox::client {

// The voxels of a scene as seen from one direction: an upper bound of their height, found brick by brick. So rays of
// that direction can skip empty space. Everything is in the frame of the scene.
class VoxelFront {
 public:
  // The scene from one direction.
  struct View {
    Vec3d towards;      // unit length
    double square = 2;  // the bound holds for squares of this edge: larger ones are found sooner, and tell less
  };

  // Returns the fronts of the views, or parts of them if the call is cancelled. Precondition: scene.Seal().
  static std::vector<VoxelFront> Of(const VoxelScene& scene, std::span<const View> views,
                                    const Cancellation& cancellation = {});

  // Returns a bound t: no cell meets point + s * towards for s > t. Minus infinity: no cell on the whole line.
  double Reach(const Vec3d& point) const {
    const Vec3d at = Project(point);
    const double x = at[0] - low_[0], y = at[1] - low_[1];
    if (!(x >= 0 && x < size_[0] && y >= 0 && y < size_[1])) return kNothing;
    return front_[Square(static_cast<int>(x), static_cast<int>(y))] - at[2];
  }

 private:
  // Returns the position: two coordinates in squares of the plane, and the height along `towards`.
  Vec3d Project(const Vec3d& point) const {
    return {Dot(point, u_) / square_, Dot(point, v_) / square_, Dot(point, towards_)};
  }

  explicit VoxelFront(const View& view);
  void Place(const VoxelScene& scene);
  void Add(const VoxelScene& scene, std::span<const Brick> shells);

  size_t Square(int x, int y) const {  // index in front_
    return static_cast<size_t>(y) * static_cast<size_t>(size_[0]) + static_cast<size_t>(x);
  }

  static constexpr float kNothing = -std::numeric_limits<float>::infinity();

  double square_;  // edge
  Vec3d u_, v_, towards_;
  double radius_ = 0;            // of a ball around a cell
  std::array<double, 2> low_{};  // of the squares; a whole number
  std::array<int, 2> size_{};    // squares
  std::vector<float> front_;     // of each square
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_VOXEL_FRONT_H_
