#include "latvox/dense.h"

#include <algorithm>
#include <limits>
#include <new>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "latvox/error.h"
#include "latvox/for_each_voxel.h"

namespace latvox::client {
namespace {

bool Contains(const IndexBox& box, const Vec3i& ijk) {
  for (size_t m = 0; m < 3; ++m) {
    if (ijk[m] < box.min[m] || ijk[m] >= box.max[m]) return false;
  }
  return true;
}

// Returns an array without values. Errors: as ToDense, except for its memory.
absl::StatusOr<DenseVoxels> Shaped(const IndexBox& box, uint64_t most_points) {
  DenseVoxels dense{.box = box};
  for (size_t m = 0; m < 3; ++m) {
    if (box.max[m] >= box.min[m]) continue;
    absl::Status status =
        absl::InvalidArgumentError(absl::StrCat("box.max[", m, "]: ", box.max[m], " is below box.min, ", box.min[m]));
    SetErrorDetails({.reason = "BAD_BOX",
                     .field = "box.max",
                     .value = absl::StrCat(box.max[m]),
                     .limit = absl::StrCat(box.min[m]),
                     .retry_after = std::nullopt},
                    status);
    return status;
  }
  for (size_t m = 0; m < 3; ++m) dense.shape[m] = static_cast<size_t>(int64_t{box.max[m]} - box.min[m]);
  const auto& [ni, nj, nk] = dense.shape;
  // The product of all three sides may exceed 64 bits.
  const bool empty = ni == 0 || nj == 0 || nk == 0;
  if (!empty && (ni > most_points / nj || ni * nj > most_points / nk)) {
    const std::string value = absl::StrJoin(dense.shape, " x ");
    absl::Status status =
        absl::ResourceExhaustedError(absl::StrCat("box: ", value, " points exceed the limit of ", most_points));
    SetErrorDetails({.reason = "LIMIT_EXCEEDED",
                     .field = "box",
                     .value = value,
                     .limit = absl::StrCat(most_points),
                     .retry_after = std::nullopt},
                    status);
    return status;
  }
  dense.strides = {nj * nk, nk, 1};
  return dense;
}

// Returns values for points that are no voxels. Throws std::bad_alloc.
FieldValues Empty(const FieldValues& like, size_t points) {
  FieldValues values{like.field, {}, like.neighbors, like.labels};
  const FieldFacts& facts = FactsOf(like.field);
  const bool is_number = facts.type == NumberType::kUint32;
  values.bytes.resize(points * values.bytes_of_voxel(), is_number ? std::byte{0xFF} : std::byte{0});
  if (facts.type != NumberType::kFloat32) return values;
  auto* const numbers = reinterpret_cast<float*>(values.bytes.data());
  std::fill_n(numbers, points * values.components(), std::numeric_limits<float>::quiet_NaN());
  return values;
}

// Fills the array, until the call is cancelled. Throws std::bad_alloc.
void Fill(const BrickBatch& all, const Cancellation& cancellation, DenseVoxels& dense) {
  const size_t points = dense.shape[0] * dense.shape[1] * dense.shape[2];
  dense.voxels.resize(points);
  for (const FieldValues& values : all.fields) dense.fields.push_back(Empty(values, points));
  size_t number = 0;
  for (const Brick& brick : all.bricks) {
    if (cancellation.cancelled()) return;
    ForEachVoxel(brick, [&](const Vec3i& ijk) {
      const size_t voxel = number++;
      if (!Contains(dense.box, ijk)) return;
      const size_t n = dense.IndexOf(ijk);
      dense.voxels[n] = 1;
      for (size_t f = 0; f < all.fields.size(); ++f) {
        const size_t bytes = all.fields[f].bytes_of_voxel();
        std::copy_n(&all.fields[f].bytes[voxel * bytes], bytes, &dense.fields[f].bytes[n * bytes]);
      }
    });
  }
}

}  // namespace

absl::StatusOr<DenseVoxels> ToDense(const BrickBatch& all, const IndexBox& box, uint64_t most_points,
                                    const Cancellation& cancellation) {
  absl::StatusOr<DenseVoxels> dense = Shaped(box, most_points);
  if (!dense.ok()) return dense;
  try {
    Fill(all, cancellation, *dense);
    if (cancellation.cancelled()) return absl::CancelledError("cancelled");
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(
        absl::StrCat("not enough memory for a box of ", absl::StrJoin(dense->shape, " x "), " points"));
  }
  return dense;
}

absl::StatusOr<DenseVoxels> ToDense(std::span<const Brick> bricks, const IndexBox& box, uint64_t most_points) {
  return ToDense(BrickBatch{.bricks = bricks}, box, most_points);
}

absl::StatusOr<DenseVoxels> ToDense(const Voxelization& all, const IndexBox& box, uint64_t most_points) {
  return ToDense(BrickBatch{.bricks = all.bricks, .fields = all.fields}, box, most_points);
}

absl::StatusOr<DenseVoxels> ToDense(const Voxelization& all, uint64_t most_points) {
  return ToDense(all, all.accepted.index_box.value_or(IndexBox{}), most_points);
}

}  // namespace latvox::client
