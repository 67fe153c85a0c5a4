#include "core/block/block_voxels.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

#include "core/tile/cut_out.h"

namespace latvox {
namespace {

IndexBox Union(IndexBox a, const IndexBox& b) {
  for (size_t m = 0; m < 3; ++m) {
    a.min[m] = std::min(a.min[m], b.min[m]);
    a.max[m] = std::max(a.max[m], b.max[m]);
  }
  return a;
}

}  // namespace

void BlockVoxels::Reset(const BlockBox& where) {
  where_ = where;
  bits_.ClearRange(std::exchange(dirty_, {}));
  dirty_box_ = {where_.layout.origin + where_.layout.side, where_.layout.origin};  // empty
  bits_.Resize(where_.layout.Words());
}

void BlockVoxels::MarkDirty(std::span<const uint32_t> voxels) {
  constexpr size_t kFew = 128;
  if (voxels.size() > kFew) return MarkPlanesDirty(RangeOf(voxels));
  for (const uint32_t voxel : voxels) {
    const uint32_t number = voxel & kNumberMask;
    dirty_.Add({number, number});
    const Vec3i ijk = where_.layout.VoxelAt(number);
    dirty_box_ = Union(dirty_box_, {ijk, ijk + Vec3i{1, 1, 1}});
  }
}

void BlockVoxels::MarkPlanesDirty(const NumberRange& voxels) {
  if (voxels.empty()) return;
  dirty_.Add(voxels);
  const BitsLayout& layout = where_.layout;
  IndexBox planes{layout.origin, layout.origin + layout.side};
  planes.min[0] = layout.VoxelAt(voxels.first)[0];
  planes.max[0] = layout.VoxelAt(voxels.last)[0] + 1;
  dirty_box_ = Union(dirty_box_, planes);
}

// Rows of a tile begin at whole bytes.
void BlockVoxels::AddRows(const Vec3i& tile_ijk, std::span<const uint64_t> rows) {
  static_assert(std::endian::native == std::endian::little, "words of both sizes are read as bytes");
  auto* const bytes = reinterpret_cast<char*>(bits_.words().data());
  const Vec3i low = tile_ijk * kTileSide;
  NumberRange added_range;
  for (int32_t row = 0; row < kTileSide * kTileSide; ++row) {
    const uint64_t added = rows[static_cast<size_t>(row)];
    if (added == 0) continue;
    const uint32_t number = where_.layout.NumberOf(low + Vec3i{row / kTileSide, row % kTileSide, 0});
    added_range.Add({number, number + kTileSide - 1});
    char* const at = bytes + number / 8;
    uint64_t word;
    std::memcpy(&word, at, sizeof(word));
    word |= added;
    std::memcpy(at, &word, sizeof(word));
  }
  MarkPlanesDirty(added_range);
}

TileBricks BlockVoxels::CutOut(const TileContext& context, const Vec3i& tile_ijk) const {
  IndexBox dirty;  // in whole bricks, which need no clipping
  for (size_t m = 0; m < 3; ++m) {
    dirty.min[m] = dirty_box_.min[m] & -kBrickSide;
    dirty.max[m] = (dirty_box_.max[m] + kBrickSide - 1) & -kBrickSide;
  }
  return latvox::CutOut(where_.layout, bits_, tile_ijk * kTileSide, Intersection(context.region, dirty),
                        context.mesh.base_ijk);
}

}  // namespace latvox
