#include "client/tool/output/box_shape.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "latvox/error.h"
#include "latvox/for_each_voxel.h"

namespace latvox::client {

absl::StatusOr<IndexBox> ShapedBox(const IndexBox& box, const BoxShape& shape, const std::string& target) {
  const auto pad = static_cast<int32_t>(shape.pad);
  IndexBox shaped = box;
  for (size_t m = 0; m < 3; ++m) {
    shaped.min[m] -= pad;
    shaped.max[m] += pad;
    if (!shape.dims) continue;
    const int32_t wanted = (*shape.dims)[m], side = shaped.max[m] - shaped.min[m];
    if (side > wanted) {
      absl::Status status = absl::InvalidArgumentError(absl::StrCat(
          target, ": --dims: ", wanted, " along ", std::string(1, "ijk"[m]), " is less than the ", side,
          " points that the voxels take", pad > 0 ? " with their padding" : "", "; ask for coarser voxels"));
      SetErrorDetails({"BAD_SPEC", "--dims", absl::StrCat(wanted), absl::StrCat(side), std::nullopt}, status);
      return status;
    }
    shaped.min[m] -= (wanted - side) / 2;
    shaped.max[m] = shaped.min[m] + wanted;
  }
  return shaped;
}

void VoxelBox::Add(const Brick& brick) {
  constexpr int32_t kSide = 8;
  bool is_inside = box_.has_value();
  for (size_t m = 0; m < 3 && is_inside; ++m) {
    const int32_t low = brick.brick_ijk[m] * kSide;
    is_inside = low >= box_->min[m] && low + kSide <= box_->max[m];
  }
  if (is_inside) return;
  ForEachVoxel(brick, [this](const Vec3i& ijk) {
    if (!box_) box_ = IndexBox{ijk, ijk};
    for (size_t m = 0; m < 3; ++m) {
      box_->min[m] = std::min(box_->min[m], ijk[m]);
      box_->max[m] = std::max(box_->max[m], ijk[m] + 1);
    }
  });
}

}  // namespace latvox::client
