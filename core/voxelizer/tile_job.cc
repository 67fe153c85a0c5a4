#include "core/voxelizer/tile_job.h"

#include <algorithm>
#include <cstdlib>

#include "core/digitize/crossing.h"
#include "core/thin/thin.h"
#include "core/tile/tile_box.h"

namespace latvox {
namespace {

// Most tiles can be thinned knowing two steps around them; the rest are done again with all that may matter.
constexpr std::array<int32_t, 2> kHalos{2, kThinHalo};
constexpr size_t kCancelInterval = 1024;  // triangles between two looks at `cancelled`

Vec3i Times(const Vec3i& v, int32_t s) { return v * s; }

// Whether no lattice edge with its nearer end in `box` can meet the triangle.
bool IsFarFrom(const Triangle& v, const IndexBox& box, const Vec3i& reach) {
  for (size_t m = 0; m < 3; ++m) {
    const auto [low, high] = std::minmax({v[0][m], v[1][m], v[2][m]});
    const int32_t half_reach = reach[m] * kLatticeUnit / 2;
    if (high < box.min[m] * kLatticeUnit - half_reach || (box.max[m] - 1) * kLatticeUnit + half_reach < low)
      return true;
  }
  return false;
}

// Adds the nearer ends of all crossed edges to `set` if they lie in `box`; lists the edges if they are asked for.
void Scan(const TileContext& context, const std::vector<uint32_t>& triangles, const IndexBox& box, TileBox& set,
          std::vector<CrossedEdge>* edges) {
  const SnappedMesh& mesh = context.mesh;
  for (size_t n = 0; n < triangles.size(); ++n) {
    if (n % kCancelInterval == 0 && context.cancelled) return;
    const auto& [v0, v1, v2] = mesh.triangles[triangles[n]];
    const Triangle triangle{mesh.vertices_lat[v0], mesh.vertices_lat[v1], mesh.vertices_lat[v2]};
    if (IsFarFrom(triangle, box, context.reach)) continue;
    for (const Frame& frame : context.frames) {
      ForEachCrossing(triangle, frame, box, [&](const Vec3i& nearer, const Vec3i& farther) {
        const uint32_t index = set.IndexOf(nearer);
        set.Set(index);
        if (edges != nullptr) edges->push_back({index, set.IndexOf(farther)});
      });
    }
  }
}

TileBox ThinnedSet(const TileContext& context, const Vec3i& tile_ijk, const IndexBox& tile,
                   const std::vector<uint32_t>& triangles) {
  const int32_t longest = *std::max_element(context.reach.begin(), context.reach.end());
  std::vector<CrossedEdge> edges;
  for (const int32_t halo : kHalos) {
    const IndexBox known{tile.min - Times(context.reach, halo), tile.max + Times(context.reach, halo)};
    TileBox set(tile_ijk, longest * (halo + 1));
    edges.clear();
    Scan(context, triangles, known, set, &edges);
    if (Thin(set, edges, known, context.reach, tile) || halo == kHalos.back()) return set;
  }
  std::abort();  // the last halo returns
}

// Clears the voxels of a brick (local corner) that lie outside of the region.
void ClipToRegion(const Vec3i& corner, const IndexBox& region, BrickMask& mask) {
  for (int32_t n = 0; n < 512; ++n) {
    const Vec3i ijk = corner + Vec3i{n >> 6, n >> 3 & 7, n & 7};
    if (!region.Contains(ijk)) mask[static_cast<size_t>(n >> 6)] &= ~(uint64_t{1} << (n & 63));
  }
}

bool Inside(const IndexBox& inner, const IndexBox& outer) {
  for (size_t m = 0; m < 3; ++m) {
    if (inner.min[m] < outer.min[m] || inner.max[m] > outer.max[m]) return false;
  }
  return true;
}

TileBricks CutOut(const TileContext& context, const IndexBox& tile, const TileBox& set) {
  TileBricks out;
  const bool clip = !Inside(tile, context.region);
  constexpr int32_t kSide = kTileSide / kBrickSide;
  for (int32_t n = 0; n < kSide * kSide * kSide; ++n) {
    const Vec3i corner = tile.min + Vec3i{n / (kSide * kSide), n / kSide % kSide, n % kSide} * kBrickSide;
    BrickMask mask;
    std::copy_n(set.words().begin() + (set.IndexOf(corner) >> 6), mask.size(), mask.begin());
    if (clip) ClipToRegion(corner, context.region, mask);
    const uint64_t voxels = CountVoxels(mask);
    if (voxels == 0) continue;
    Vec3i brick_ijk = corner + context.mesh.base_ijk;
    for (int32_t& x : brick_ijk) x >>= kBrickBits;
    out.bricks.push_back({brick_ijk, mask});
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

// Half an edge beyond the outermost voxel that thinning looks at.
Vec3i TileContext::Margin() const { return Times(reach, minimal ? kThinHalo + 1 : 1); }

std::optional<TileBricks> DigitizeTile(const TileContext& context, const Vec3i& tile_ijk,
                                       const std::vector<uint32_t>& triangles) {
  const Vec3i low = tile_ijk * kTileSide;
  const IndexBox tile{low, low + Vec3i{kTileSide, kTileSide, kTileSide}};
  const auto digitize = [&] {
    if (context.minimal) return ThinnedSet(context, tile_ijk, tile, triangles);
    TileBox set(tile_ijk, 0);
    Scan(context, triangles, tile, set, nullptr);
    return set;
  };
  TileBricks out = CutOut(context, tile, digitize());
  if (out.bricks.empty() || context.cancelled) return std::nullopt;
  for (size_t m = 0; m < 3; ++m) out.tile_ijk[m] = tile_ijk[m] + (context.mesh.base_ijk[m] >> kTileBits);
  return out;
}

}  // namespace latvox
