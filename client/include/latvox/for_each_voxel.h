// Visits the voxels of bricks.
//
//   ForEachVoxel(*all, [](const latvox::client::Voxel& voxel) { std::printf("%d\n", voxel.ijk[0]); });
#ifndef LATVOX_LATVOX_FOR_EACH_VOXEL_H_
#define LATVOX_LATVOX_FOR_EACH_VOXEL_H_

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "latvox/export.h"
#include "latvox/types.h"

namespace latvox::client {

// One voxel of a batch or of a whole voxelization.
struct Voxel {
  Vec3i ijk;                             // lattice coordinates; GridTransform::ToWorld gives its center
  std::optional<float> distance;         // of a band, world units; absent for other sets
  std::span<const uint32_t> attributes;  // one number for each of VoxelizeRequest::attributes, in their order
};

// Calls visit(ijk) with the lattice coordinates of each voxel of the brick, in lexicographic order.
template <class Visit>
void ForEachVoxel(const Brick& brick, Visit&& visit) {
  for (int32_t x = 0; x < 8; ++x) {
    for (uint64_t word = brick.mask[static_cast<size_t>(x)]; word != 0; word &= word - 1) {
      const int32_t yz = std::countr_zero(word);
      const auto& [i, j, k] = brick.brick_ijk;
      visit(Vec3i{8 * i + x, 8 * j + (yz >> 3), 8 * k + (yz & 7)});
    }
  }
}

// Returns the number of voxels in the brick, 0 to 512.
LATVOX_EXPORT size_t CountVoxels(const Brick& brick);

// Returns the number of attributes that each voxel of the batch carries; 0 if there is no voxel.
inline size_t AttributesPerVoxel(const BrickBatch& batch) {
  size_t voxels = 0;
  for (const Brick& brick : batch.bricks) voxels += CountVoxels(brick);
  return voxels == 0 ? 0 : batch.attributes.size() / voxels;
}

// Calls visit(voxel) with each Voxel of the batch, brick after brick. Its attributes are valid as long as the batch's.
// Precondition: `values` is empty or has a number for each voxel, and `attributes` has equally many for each voxel. The
// SDK checks this for every batch that it passes on.
template <class Visit>
void ForEachVoxel(const BrickBatch& batch, Visit&& visit) {
  const size_t width = AttributesPerVoxel(batch);
  size_t n = 0;
  for (const Brick& brick : batch.bricks) {
    ForEachVoxel(brick, [&](const Vec3i& ijk) {
      Voxel voxel{ijk, std::nullopt, batch.attributes.subspan(n * width, width)};
      if (!batch.values.empty()) voxel.distance = batch.values[n];
      ++n;
      visit(static_cast<const Voxel&>(voxel));
    });
  }
}

// Does the same with a whole voxelization.
template <class Visit>
void ForEachVoxel(const Voxelization& all, Visit&& visit) {
  ForEachVoxel(BrickBatch{.bricks = all.bricks, .progress = 1, .values = all.values, .attributes = all.attributes},
               visit);
}

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_FOR_EACH_VOXEL_H_
