#include "core/block/link_ends.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <iterator>

#include "core/base/bytes_of.h"
#include "core/block/star_batches.h"
#include "core/scan/open_stars.h"

namespace latvox {

void LinkEnds::Find(const TileContext& context, const TileNode& node) {
  std::span<const uint32_t> triangles = node.triangles;
  if (!context.is_tiny.empty()) {
    others_.clear();
    std::ranges::copy_if(triangles, std::back_inserter(others_), [&](uint32_t t) { return context.is_tiny[t] == 0; });
    triangles = others_;
  }
  voxels_.Reset(BlockBox(context, node, 1));
  const BlockBox& where = voxels_.where();
  const auto add = [this](const auto& some) {
    voxels_.Add(some.nearer.view());
    voxels_.Add(some.farther.view());
  };
  where.ForEachTinyBatch(context, add);
  candidates_.Reset(triangles, context.frames);
  const NeighborRows rows(context.frames, where.layout);
  candidates_.ForEach(context, where, [&](const Candidates& candidates) {
    if (context.stop.Stopped()) return;
    add(candidates);
    for (size_t run = 0; run < candidates.runs.size() && !context.stop.Stopped(); ++run) {
      constexpr size_t kFew = 64;  // their ends are then in the set, so fewer of the later stars are open
      AppendOpenStars(context.mesh, context.frames, where.layout, rows, voxels_.bits(), candidates, run, pairs_);
      if (pairs_.size() >= kFew) AddStars(context);
    }
    AddStars(context);
  });
}

// Bits are set without a look at them: whether a bit is set already is hard to predict.
void LinkEnds::AddStars(const TileContext& context) {
  const BlockBox& where = voxels_.where();
  TileBits& bits = voxels_.bits();
  NumberRange nearer;
  const auto all = [](uint32_t) { return true; };
  ForEachStar(context, where.layout, pairs_, all, [&](uint32_t voxel, const StarLinks& star) {
    if (star.nearer == 0) return;
    bits.Set(voxel);
    nearer.Add({voxel, voxel});
    for (uint32_t links = star.nearer; links != 0; links &= links - 1) {
      bits.Set(where.EndOf(voxel, star, static_cast<size_t>(std::countr_zero(links))));
    }
  });
  pairs_.clear();
  if (nearer.empty()) return;
  // The layout has one step more than the box of nearer ends.
  uint32_t step = 0;
  for (const int32_t n : where.steps) step = std::max(step, static_cast<uint32_t>(std::abs(n)));
  voxels_.MarkPlanesDirty({nearer.first - step, nearer.last + step});
}

size_t LinkEnds::Bytes() const { return voxels_.Bytes() + candidates_.Bytes() + BytesOf(pairs_) + BytesOf(others_); }

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
