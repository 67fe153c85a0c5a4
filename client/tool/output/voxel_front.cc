#include "client/tool/output/voxel_front.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "latvox/plane_types.h"

namespace latvox::client {
namespace {

constexpr double kSlack = 1e-2;  // margin for single precision
constexpr double kFar = std::numeric_limits<double>::max();

}  // namespace

VoxelFront::VoxelFront(const VoxelScene& scene, const Vec3d& towards) : towards_(towards) {
  u_ = Unit(Cross(std::abs(towards[1]) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0}, towards));
  v_ = Cross(towards, u_);
  // A cell lies within a ball around its center.
  double radius = 0;
  for (const Vec3d& corner : scene.cell_corners()) radius = std::max(radius, Length(corner));
  const double across = radius / kSquare;
  Vec2d low = {kFar, kFar}, high = {-kFar, -kFar};
  scene.ForEachBrick([&](const Brick& brick) {
    for (int corner = 0; corner < 8; ++corner) {  // between which all cells of the brick lie
      const auto place = [&](int m) { return brick.brick_ijk[static_cast<size_t>(m)] * 8 + (corner >> m & 1) * 7; };
      const Vec3d at = Project(scene.CenterOf({place(0), place(1), place(2)}));
      for (size_t m = 0; m < 2; ++m) {
        low[m] = std::min(low[m], at[m] - across - kSlack);
        high[m] = std::max(high[m], at[m] + across + kSlack);
      }
    }
  });
  for (size_t m = 0; m < 2 && !scene.empty(); ++m) {
    low_[m] = Floor(low[m]);
    size_[m] = Floor(high[m]) + 1 - low_[m];
  }
  front_.assign(static_cast<size_t>(size_[0]) * static_cast<size_t>(size_[1]), kNothing);
  scene.ForEachOuter([&](const Vec3i& cell) {
    const Vec3d at = Project(scene.CenterOf(cell));
    const int left = Floor(at[0] - across), right = Floor(at[0] + across);
    const int low_y = Floor(at[1] - across), high_y = Floor(at[1] + across);
    const auto height = static_cast<float>(at[2] + radius + kSlack);
    for (int y = low_y; y <= high_y; ++y) {
      for (int x = left; x <= right; ++x) {
        float& front = front_[Square(x, y)];
        front = std::max(front, height);
      }
    }
  });
}

}  // namespace latvox::client
