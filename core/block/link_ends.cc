#include "core/block/link_ends.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <iterator>

#include "core/base/bytes_of.h"

namespace latvox {

void LinkEnds::Find(const TileContext& context, const TileNode& node) {
  std::span<const uint32_t> triangles = node.triangles;
  if (!context.is_tiny.empty()) {
    others_.clear();
    std::ranges::copy_if(triangles, std::back_inserter(others_), [&](uint32_t t) { return context.is_tiny[t] == 0; });
    triangles = others_;
  }
  scan_.Begin(context, node, triangles);
  const BlockBox& where = scan_.where();
  voxels_.Reset(where);
  where.ForEachTinyBatch(context, [this](const Crossings& some) {
    voxels_.Add(some.nearer.view());
    voxels_.Add(some.farther.view());
  });
  // Bits are set without a look at them: whether a bit is set already is hard to predict.
  TileBits& bits = voxels_.bits();
  NumberRange nearer;
  scan_.ForEachStar(context, [&](const VoxelTriangle& pair, const StarLinks& star) {
    bits.Set(pair.voxel);
    nearer.Add({pair.voxel, pair.voxel});
    for (uint32_t links = star.nearer; links != 0; links &= links - 1) {
      bits.Set(where.EndOf(pair.voxel, star, static_cast<size_t>(std::countr_zero(links))));
    }
  });
  if (nearer.empty()) return;
  // The layout has one step more than the box of nearer ends.
  uint32_t step = 0;
  for (const int32_t n : where.steps) step = std::max(step, static_cast<uint32_t>(std::abs(n)));
  voxels_.MarkPlanesDirty({nearer.first - step, nearer.last + step});
}

size_t LinkEnds::Bytes() const { return scan_.Bytes() + voxels_.Bytes() + BytesOf(others_); }

void KeepSide(LinkSide side, std::span<const uint64_t> inside, TileBricks& tile) {
  if (side == LinkSide::kBoth) return;
  const uint64_t flip = side == LinkSide::kOutside ? ~uint64_t{0} : 0;
  tile.voxels = 0;
  for (Brick& brick : tile.bricks) {
    const Vec3i at = brick.brick_ijk * kBrickSide - tile.tile_ijk * kTileSide;
    for (int32_t x = 0; x < kBrickSide; ++x) {
      uint64_t kept = 0;
      for (int32_t y = 0; y < kBrickSide; ++y) {
        const uint64_t row = inside[static_cast<size_t>((at[0] + x) << kTileBits | (at[1] + y))] ^ flip;
        kept |= (row >> at[2] & 0xFF) << (y << kBrickBits);
      }
      brick.mask[static_cast<size_t>(x)] &= kept;
    }
    tile.voxels += CountVoxels(brick.mask);
  }
  std::erase_if(tile.bricks, [](const Brick& brick) { return CountVoxels(brick.mask) == 0; });
}

}  // namespace latvox
