#include "client/output/voxel_front.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "client/output/vec3.h"

namespace latvox::client {
namespace {

constexpr double kSquare = 4;  // edge
constexpr double kNothing = -std::numeric_limits<double>::infinity();

int Floor(double x) { return static_cast<int>(std::floor(x)); }

}  // namespace

VoxelFront::VoxelFront(const VoxelScene& scene, const Vec3d& towards) : towards_(towards) {
  u_ = Unit(Cross(std::abs(towards[1]) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0}, towards));
  v_ = Cross(towards, u_);
  // A brick is within a ball about its middle.
  std::vector<Vec3d> balls;
  scene.ForEachBrick([&](const Brick& brick) {
    const Vec3i& b = brick.brick_ijk;
    const Vec3d low = scene.CenterOf({8 * b[0], 8 * b[1], 8 * b[2]}),
                high = scene.CenterOf({8 * b[0] + 7, 8 * b[1] + 7, 8 * b[2] + 7});
    balls.push_back(Project(Sum(low, 0.5, Sum(high, -1, low))));
  });
  double radius = 0, cell = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const auto side = [&](int m) { return corner >> m & 1 ? 7 : 0; };
    const Vec3d middle = Sum({}, 0.5, scene.CenterOf({7, 7, 7}));
    radius = std::max(radius, Length(Sum(scene.CenterOf({side(0), side(1), side(2)}), -1, middle)));
  }
  for (const Vec3d& corner : scene.cell_corners()) cell = std::max(cell, Length(corner));
  radius += cell;
  const double across = radius / kSquare;
  for (size_t m = 0; m < 2 && !balls.empty(); ++m) {
    const auto [least, most] =
        std::minmax_element(balls.begin(), balls.end(), [m](const Vec3d& a, const Vec3d& b) { return a[m] < b[m]; });
    low_[m] = Floor((*least)[m] - across);
    size_[m] = Floor((*most)[m] + across) + 1 - low_[m];
  }
  front_.assign(static_cast<size_t>(size_[0]) * static_cast<size_t>(size_[1]), kNothing);
  for (const Vec3d& ball : balls) {
    for (int y = Floor(ball[1] - across); y <= Floor(ball[1] + across); ++y) {
      for (int x = Floor(ball[0] - across); x <= Floor(ball[0] + across); ++x) {
        double& front =
            front_[static_cast<size_t>(y - low_[1]) * static_cast<size_t>(size_[0]) + static_cast<size_t>(x - low_[0])];
        front = std::max(front, ball[2] + radius);
      }
    }
  }
}

Vec3d VoxelFront::Project(const Vec3d& point) const {
  return {Dot(point, u_) / kSquare, Dot(point, v_) / kSquare, Dot(point, towards_)};
}

double VoxelFront::Reach(const Vec3d& point) const {
  const Vec3d at = Project(point);
  const int x = Floor(at[0]) - low_[0], y = Floor(at[1]) - low_[1];
  if (x < 0 || y < 0 || x >= size_[0] || y >= size_[1]) return kNothing;
  return front_[static_cast<size_t>(y) * static_cast<size_t>(size_[0]) + static_cast<size_t>(x)] - at[2];
}

}  // namespace latvox::client
