#include "client/tool/output/picture_scene.h"

#include <algorithm>
#include <limits>

#include "client/internal/vec3.h"
#include "client/tool/output/cell_index.h"
#include "client/tool/output/voronoi_cell.h"
#include "latvox/for_each_voxel.h"

namespace latvox::client {

double SkinDepth(const GridTransform& grid) {
  double longest = 0;
  for (const CellFace& face : VoronoiCellOf(grid.basis).faces) {
    const Vec3i& w = face.neighbor;
    longest = std::max(longest, Length(Combine(grid.basis, {double(w[0]), double(w[1]), double(w[2])})));
  }
  return longest / 2;
}

std::vector<Brick> SkinOf(const BrickBatch& batch, double depth, std::vector<uint32_t>& colors) {
  std::vector<Brick> skin;
  const std::span<const float> distances = FindField(batch.fields, Field::kDistance)->As<float>();
  size_t voxel = 0, kept = 0;
  for (const Brick& brick : batch.bricks) {
    Brick near{brick.brick_ijk, {}};
    bool any = false;
    ForEachVoxel(brick, [&](const Vec3i& ijk) {
      const size_t n = voxel++;
      if (distances[n] > depth) return;
      if (!colors.empty()) colors[kept++] = colors[n];
      near.mask[WordInBrick(ijk)] |= BitInWord(ijk);
      any = true;
    });
    if (any) skin.push_back(near);
  }
  colors.resize(kept);
  return skin;
}

double DiagonalOf(std::span<const Brick> bricks, const GridTransform& grid) {
  constexpr int32_t kFar = std::numeric_limits<int32_t>::max();
  IndexBox box{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
  for (const Brick& brick : bricks) {
    ForEachVoxel(brick, [&box](const Vec3i& ijk) {
      for (size_t m = 0; m < 3; ++m) {
        box.min[m] = std::min(box.min[m], ijk[m]);
        box.max[m] = std::max(box.max[m], ijk[m] + 1);
      }
    });
  }
  if (bricks.empty()) return 0;
  double longest = 0;
  for (int corner = 0; corner < 4; ++corner) {
    Vec3d across{};
    for (size_t m = 0; m < 3; ++m) {
      const double side = static_cast<double>(int64_t{box.max[m]} - box.min[m]);
      across[m] = m < 2 && (corner >> m & 1) != 0 ? -side : side;
    }
    longest = std::max(longest, Length(Combine(grid.basis, across)));
  }
  return longest;
}

void AddBricks(std::span<const Brick> bricks, std::span<const uint32_t> colors, VoxelScene& scene) {
  for (const Brick& brick : bricks) {
    if (colors.empty()) {
      scene.Add(brick);
      continue;
    }
    const size_t voxels = CountVoxels(brick);
    scene.Add(brick, colors.first(voxels));
    colors = colors.subspan(voxels);
  }
}

}  // namespace latvox::client
