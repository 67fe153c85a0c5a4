#include "client/tool/output/voxel_front.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "latvox/plane_types.h"

namespace latvox::client {
namespace {

constexpr double kSlack = 1e-2;  // margin for single precision
constexpr double kFar = std::numeric_limits<double>::max();

}  // namespace

VoxelFront::VoxelFront(const VoxelScene& scene, const Vec3d& towards, double square)
    : square_(square), towards_(towards) {
  u_ = Unit(Cross(std::abs(towards[1]) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0}, towards));
  v_ = Cross(towards, u_);
  // A cell lies within a ball around its center.
  double radius = 0;
  for (const Vec3d& corner : scene.cell_corners()) radius = std::max(radius, Length(corner));
  const double across = radius / square_;
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
    low_[m] = std::floor(low[m]);
    size_[m] = static_cast<int>(std::floor(high[m]) + 1 - low_[m]);
  }
  front_.assign(static_cast<size_t>(size_[0]) * static_cast<size_t>(size_[1]), kNothing);
  AddCells(scene, radius);
}

// A projection is linear, so those of all cells of a brick are at the same places beside that of its first cell.
void VoxelFront::AddCells(const VoxelScene& scene, double radius) {
  const double across = radius / square_;
  std::array<Vec3d, 512> places;
  for (int32_t n = 0; n < 512; ++n) {
    places[static_cast<size_t>(n)] = Project(scene.CenterOf({n >> 6, n >> 3 & 7, n & 7}));
  }
  scene.ForEachOuterBrick([&](const Brick& brick) {
    const auto& [i, j, k] = brick.brick_ijk;
    const Vec3d first = Project(scene.CenterOf({8 * i, 8 * j, 8 * k}));
    const double x = first[0] - low_[0], y = first[1] - low_[1], z = first[2] + radius + kSlack;
    for (size_t word = 0; word < brick.mask.size(); ++word) {
      for (uint64_t bits = brick.mask[word]; bits != 0; bits &= bits - 1) {
        const Vec3d& place = places[word * 64 + static_cast<size_t>(std::countr_zero(bits))];
        const double at_x = x + place[0], at_y = y + place[1];
        const int left = static_cast<int>(at_x - across), right = static_cast<int>(at_x + across);
        const int top = static_cast<int>(at_y - across), bottom = static_cast<int>(at_y + across);
        const auto height = static_cast<float>(z + place[2]);
        for (int row = top; row <= bottom; ++row) {
          for (int column = left; column <= right; ++column) {
            float& front = front_[Square(column, row)];
            front = std::max(front, height);
          }
        }
      }
    }
  });
}

}  // namespace latvox::client
