#include "client/tool/output/voxel_front.h"

#include <oneapi/tbb/parallel_for.h>

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

// Shells are found once for all views, a few bricks at a time: those of a solid would take as much memory as the scene.
std::vector<VoxelFront> VoxelFront::Of(const VoxelScene& scene, std::span<const View> views,
                                       const Cancellation& cancellation) {
  constexpr size_t kBatch = 4096;
  std::vector<VoxelFront> fronts;
  for (const View& view : views) fronts.push_back(VoxelFront(view));
  const auto for_each_front = [&](const auto& work) { tbb::parallel_for(size_t{0}, fronts.size(), work); };
  for_each_front([&](size_t n) { fronts[n].Place(scene); });
  std::vector<Brick> shells;
  const auto add = [&] {
    tbb::parallel_for(size_t{0}, shells.size(), [&](size_t n) { shells[n] = scene.ShellOf(shells[n]); });
    for_each_front([&](size_t n) { fronts[n].Add(scene, shells); });
    shells.clear();
  };
  scene.ForEachOuterBrick([&](const Brick& brick) {
    if (cancellation.cancelled()) return;
    shells.push_back(brick);
    if (shells.size() == kBatch) add();
  });
  add();
  return fronts;
}

VoxelFront::VoxelFront(const View& view) : square_(view.square), towards_(view.towards) {
  u_ = Unit(Cross(std::abs(towards_[1]) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0}, towards_));
  v_ = Cross(towards_, u_);
}

// Takes the box around the centers of each brick.
void VoxelFront::Place(const VoxelScene& scene) {
  for (const Vec3d& corner : scene.cell_corners()) radius_ = std::max(radius_, Length(corner));
  Vec3d half{};
  for (const Vec3i& axis : {Vec3i{1, 0, 0}, Vec3i{0, 1, 0}, Vec3i{0, 0, 1}}) {
    const Vec3d step = Project(scene.CenterOf(axis));
    for (size_t m = 0; m < 2; ++m) half[m] += 3.5 * std::abs(step[m]);
  }
  Vec2d low = {kFar, kFar}, high = {-kFar, -kFar};
  scene.ForEachOuterBrick([&](const Brick& brick) {
    const auto& [i, j, k] = brick.brick_ijk;
    const Vec3d first = Project(scene.CenterOf({8 * i, 8 * j, 8 * k}));
    const Vec3d last = Project(scene.CenterOf({8 * i + 7, 8 * j + 7, 8 * k + 7}));
    for (size_t m = 0; m < 2; ++m) {
      const double middle = (first[m] + last[m]) / 2, room = half[m] + radius_ / square_ + kSlack;
      low[m] = std::min(low[m], middle - room);
      high[m] = std::max(high[m], middle + room);
    }
  });
  for (size_t m = 0; m < 2 && !scene.empty(); ++m) {
    low_[m] = std::floor(low[m]);
    size_[m] = static_cast<int>(std::floor(high[m]) + 1 - low_[m]);
  }
  front_.assign(static_cast<size_t>(size_[0]) * static_cast<size_t>(size_[1]), kNothing);
}

// A projection is linear, so those of all cells of a brick are at the same places beside that of its first cell. No
// processor predicts how many squares the next cell covers. So each cell marks as many as any one does, some twice.
void VoxelFront::Add(const VoxelScene& scene, std::span<const Brick> shells) {
  const double across = radius_ / square_;
  const int most = static_cast<int>(std::ceil(2 * across)) + 1;
  std::array<Vec3d, 512> places;
  for (int32_t n = 0; n < 512; ++n) {
    places[static_cast<size_t>(n)] = Project(scene.CenterOf({n >> 6, n >> 3 & 7, n & 7}));
  }
  for (const Brick& shell : shells) {
    const auto& [i, j, k] = shell.brick_ijk;
    const Vec3d first = Project(scene.CenterOf({8 * i, 8 * j, 8 * k}));
    const double x = first[0] - low_[0], y = first[1] - low_[1], z = first[2] + radius_ + kSlack;
    for (size_t word = 0; word < shell.mask.size(); ++word) {
      for (uint64_t bits = shell.mask[word]; bits != 0; bits &= bits - 1) {
        const Vec3d& place = places[word * 64 + static_cast<size_t>(std::countr_zero(bits))];
        const double at_x = x + place[0], at_y = y + place[1];
        const int left = static_cast<int>(at_x - across), right = static_cast<int>(at_x + across);
        const int top = static_cast<int>(at_y - across), bottom = static_cast<int>(at_y + across);
        const auto height = static_cast<float>(z + place[2]);
        for (int down = 0; down < most; ++down) {
          float* const row = &front_[Square(0, std::min(top + down, bottom))];
          for (int along = 0; along < most; ++along) {
            float& front = row[std::min(left + along, right)];
            front = std::max(front, height);
          }
        }
      }
    }
  }
}

}  // namespace latvox::client
