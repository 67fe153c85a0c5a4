#include "client/tool/output/voxel_front.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "client/internal/vec3.h"
#include "latvox/plane_types.h"

namespace latvox::client {
namespace {

constexpr double kSquare = 2;    // edge
constexpr double kSlack = 1e-2;  // margin for single precision
constexpr double kFar = std::numeric_limits<double>::max();
constexpr float kNothing = -std::numeric_limits<float>::infinity();

int Floor(double x) { return static_cast<int>(std::floor(x)); }

}  // namespace

VoxelFront::VoxelFront(const VoxelScene& scene, const Vec3d& towards) : towards_(towards) {
  u_ = Unit(Cross(std::abs(towards[1]) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0}, towards));
  v_ = Cross(towards, u_);
  // A cell lies within a ball around its center.
  double radius = 0;
  for (const Vec3d& corner : scene.cell_corners()) radius = std::max(radius, Length(corner));
  const double across = radius / kSquare;
  Vec2d low = {kFar, kFar}, high = {-kFar, -kFar};
  scene.ForEachOuter([&](const Vec3i& cell) {
    const Vec3d at = Project(scene.CenterOf(cell));
    for (size_t m = 0; m < 2; ++m) {
      low[m] = std::min(low[m], at[m] - across);
      high[m] = std::max(high[m], at[m] + across);
    }
  });
  for (size_t m = 0; m < 2 && !scene.empty(); ++m) {
    low_[m] = Floor(low[m]);
    size_[m] = Floor(high[m]) + 1 - low_[m];
  }
  front_.assign(static_cast<size_t>(size_[0]) * static_cast<size_t>(size_[1]), kNothing);
  scene.ForEachOuter([&](const Vec3i& cell) {
    const Vec3d at = Project(scene.CenterOf(cell));
    for (int y = Floor(at[1] - across); y <= Floor(at[1] + across); ++y) {
      for (int x = Floor(at[0] - across); x <= Floor(at[0] + across); ++x) {
        float& front = front_[Square(x, y)];
        front = std::max(front, static_cast<float>(at[2] + radius + kSlack));
      }
    }
  });
}

size_t VoxelFront::Square(int x, int y) const {
  return static_cast<size_t>(y - low_[1]) * static_cast<size_t>(size_[0]) + static_cast<size_t>(x - low_[0]);
}

Vec3d VoxelFront::Project(const Vec3d& point) const {
  return {Dot(point, u_) / kSquare, Dot(point, v_) / kSquare, Dot(point, towards_)};
}

double VoxelFront::Reach(const Vec3d& point) const {
  const Vec3d at = Project(point);
  for (size_t m = 0; m < 2; ++m) {
    if (!(at[m] >= low_[m] && at[m] < low_[m] + size_[m])) return kNothing;
  }
  return front_[Square(Floor(at[0]), Floor(at[1]))] - at[2];
}

}  // namespace latvox::client
