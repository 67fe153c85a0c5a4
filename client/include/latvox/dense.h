// Voxels as a dense array.
//
//   const absl::StatusOr<latvox::client::DenseVoxels> dense = latvox::client::ToDense(*all);
//   if (!dense.ok()) return dense.status();
//   const bool is_voxel = dense->voxels[dense->IndexOf({i, j, k})] != 0;
#ifndef LATVOX_LATVOX_DENSE_H_
#define LATVOX_LATVOX_DENSE_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "latvox/cancellation.h"
#include "latvox/export.h"
#include "latvox/types.h"

namespace latvox::client {

// One value for each lattice point of a box, in C order: k runs fastest. Element 0 is the point box.min, whose center
// is GridTransform::ToWorld(box.min).
struct DenseVoxels {
  IndexBox box;                      // the lattice points
  std::array<size_t, 3> shape{};     // the number of points along i, j and k
  std::array<size_t, 3> strides{};   // the elements from one point to the next along i, j and k
  std::vector<uint8_t> voxels = {};  // 1 for a voxel, 0 for another point
  // The fields that voxels carry: FieldValues::components numbers for each point. Where there is no voxel, floats are
  // NaN, integers of 32 bits 4294967295, and others 0. Component c at element n is As<T>()[n * components + c].
  std::vector<FieldValues> fields = {};

  // Returns the element of a lattice point. Precondition: the box contains the point.
  size_t IndexOf(const Vec3i& ijk) const {
    size_t index = 0;
    for (size_t m = 0; m < 3; ++m) index += static_cast<size_t>(int64_t{ijk[m]} - box.min[m]) * strides[m];
    return index;
  }
};

// The most lattice points of a dense array, unless a program gives another limit: 1 GiB without fields.
inline constexpr uint64_t kMostDensePoints = uint64_t{1} << 30;

// Returns the voxels of the bricks that lie in the box. Memory: 1 byte for each point of the box.
// Errors, with field, value and limit in ErrorDetails: INVALID_ARGUMENT if box.max is below box.min on some axis;
// RESOURCE_EXHAUSTED if the box has more than `most_points`, or if the memory does not suffice.
LATVOX_EXPORT absl::StatusOr<DenseVoxels> ToDense(std::span<const Brick> bricks, const IndexBox& box,
                                                  uint64_t most_points = kMostDensePoints);

// Does the same with fields. Memory: 1 byte for each point, and FieldValues::bytes_of_voxel for each field.
LATVOX_EXPORT absl::StatusOr<DenseVoxels> ToDense(const Voxelization& all, const IndexBox& box,
                                                  uint64_t most_points = kMostDensePoints);

// Does the same for bricks with some fields of a call. The array has the fields in `all`, and no others. Errors as
// above, and CANCELLED.
LATVOX_EXPORT absl::StatusOr<DenseVoxels> ToDense(const BrickBatch& all, const IndexBox& box,
                                                  uint64_t most_points = kMostDensePoints,
                                                  const Cancellation& cancellation = {});

// Does the same for Accepted::index_box, which has all voxels; without any, the array has no point.
LATVOX_EXPORT absl::StatusOr<DenseVoxels> ToDense(const Voxelization& all, uint64_t most_points = kMostDensePoints);

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_DENSE_H_
