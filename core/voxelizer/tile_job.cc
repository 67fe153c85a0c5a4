#include "core/voxelizer/tile_job.h"

#include <algorithm>
#include <cstdlib>

#include "core/thin/thin.h"
#include "core/tile/tile_box.h"

namespace latvox {
namespace {

// Most tiles can be thinned knowing two steps around them; the rest are done again with all that may matter.
constexpr std::array<int32_t, 2> kHalos{2, kThinHalo};

TileBox ThinnedSet(const TileContext& context, const Vec3i& tile_ijk, const IndexBox& tile,
                   const std::vector<uint32_t>& triangles) {
  const int32_t longest = *std::max_element(context.reach.begin(), context.reach.end());
  for (const int32_t halo : kHalos) {
    std::vector<CrossedEdge> edges;
    const IndexBox known{tile.min - context.reach * halo, tile.max + context.reach * halo};
    TileBox set(tile_ijk, longest * (halo + 1));
    ScanBox(context, triangles, known, set, edges);
    const IndexBox complete{known.min + context.reach, known.max - context.reach};
    Doubtful doubtful = FindDoubtful(set, edges, complete);
    edges = EdgesAtRest(context, triangles, known, set, doubtful.rest);
    if (Thin(set, std::move(doubtful), std::move(edges), tile) || halo == kHalos.back()) return set;
  }
  std::abort();  // the last halo returns
}

TileBricks CutOut(const TileContext& context, const IndexBox& tile, const TileBox& set) {
  TileBricks out;
  constexpr int32_t kSide = kTileSide / kBrickSide;
  for (int32_t n = 0; n < kSide * kSide * kSide; ++n) {
    const Vec3i corner = tile.min + Vec3i{n / (kSide * kSide), n / kSide % kSide, n % kSide} * kBrickSide;
    Brick brick{corner, {}};
    for (int32_t& x : brick.brick_ijk) x >>= kBrickBits;
    std::copy_n(set.words().begin() + (set.IndexOf(corner) >> 6), brick.mask.size(), brick.mask.begin());
    if (brick.mask == BrickMask{}) continue;
    ClipBrick(context.region, brick);
    const uint64_t voxels = CountVoxels(brick.mask);
    if (voxels == 0) continue;
    for (size_t m = 0; m < 3; ++m) brick.brick_ijk[m] += context.mesh.base_ijk[m] >> kBrickBits;
    out.bricks.push_back(brick);
    out.voxels += voxels;
  }
  return out;
}

}  // namespace

Vec3i ReachOf(const std::vector<Frame>& frames) {
  Vec3i reach{};
  for (const Frame& frame : frames) {
    for (size_t m = 0; m < 3; ++m) reach[m] = std::max(reach[m], std::abs(frame.q[m]));
  }
  return reach;
}

std::optional<TileBricks> DigitizeTile(const TileContext& context, const Vec3i& tile_ijk,
                                       const std::vector<uint32_t>& triangles) {
  const Vec3i low = tile_ijk * kTileSide;
  const IndexBox tile{low, low + Vec3i{kTileSide, kTileSide, kTileSide}};
  const auto digitize = [&] {
    if (context.minimal) return ThinnedSet(context, tile_ijk, tile, triangles);
    TileBox set(tile_ijk, 0);
    std::vector<CrossedEdge> none;
    ScanBox(context, triangles, tile, set, none);
    return set;
  };
  TileBricks out = CutOut(context, tile, digitize());
  if (out.bricks.empty() || context.cancelled) return std::nullopt;
  for (size_t m = 0; m < 3; ++m) out.tile_ijk[m] = tile_ijk[m] + (context.mesh.base_ijk[m] >> kTileBits);
  return out;
}

}  // namespace latvox
