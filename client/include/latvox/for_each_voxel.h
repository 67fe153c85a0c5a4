// Visits the voxels of bricks.
//
//   ForEachVoxel(*all, [](const latvox::client::Voxel& voxel) { std::printf("%d\n", voxel.ijk[0]); });
#ifndef LATVOX_LATVOX_FOR_EACH_VOXEL_H_
#define LATVOX_LATVOX_FOR_EACH_VOXEL_H_

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "latvox/export.h"
#include "latvox/types.h"

namespace latvox::client {

// One voxel of a batch or of a whole voxelization.
struct Voxel {
  Vec3i ijk;                            // lattice coordinates; GridTransform::ToWorld gives its center
  size_t number;                        // among the voxels of the batch, from 0
  std::span<const FieldValues> fields;  // of all voxels of the batch

  // Returns the components of a field of this voxel; none if voxels do not carry it. T is as in FieldValues::As.
  template <class T>
  std::span<const T> Of(Field field) const {
    const FieldValues* const values = FindField(fields, field);
    if (values == nullptr) return {};
    const size_t count = values->components();
    return values->As<T>().subspan(number * count, count);
  }
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

// Calls visit(voxel) with each Voxel of the batch, brick after brick. Its fields are valid as long as the batch's.
// Precondition: fields have values for each voxel. The SDK checks this for every batch that it passes on.
template <class Visit>
void ForEachVoxel(const BrickBatch& batch, Visit&& visit) {
  size_t n = 0;
  for (const Brick& brick : batch.bricks) {
    ForEachVoxel(brick, [&](const Vec3i& ijk) { visit(Voxel{ijk, n++, batch.fields}); });
  }
}

// Does the same with a whole voxelization.
template <class Visit>
void ForEachVoxel(const Voxelization& all, Visit&& visit) {
  ForEachVoxel(BrickBatch{.bricks = all.bricks, .progress = 1, .fields = all.fields}, visit);
}

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_FOR_EACH_VOXEL_H_
