#include "core/block/tile_job.h"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <utility>

namespace latvox {

Vec3i ReachOf(const std::vector<Frame>& frames) {
  Vec3i reach{};
  for (const Frame& frame : frames) {
    for (size_t m = 0; m < 3; ++m) reach[m] = std::max(reach[m], std::abs(frame.q[m]));
  }
  return reach;
}

// Nearly all blocks can be thinned with kNearHalo steps around them. The rest are done again with the whole halo. Where
// wires or needles fill a volume, that is most blocks. So after such a block, only one in kPatience begins with the
// near halo. The voxels do not depend on that.
void FindSurface(const TileContext& context, const TileNode& node, BlockScan& scan) {
  constexpr int kPatience = 8;
  const bool try_near = scan.far_blocks % kPatience == 0;
  if (!context.minimal) {
    scan.surface.Scan(context, node, context.ScanHalo(), node.triangles);
  } else if (try_near && scan.thinner.Thin(context, scan.surface.Scan(context, node, kNearHalo, node.triangles))) {
    scan.far_blocks = 0;
  } else {
    ++scan.far_blocks;
    std::vector<uint32_t> all;
    std::merge(node.triangles.begin(), node.triangles.end(), node.fringe.begin(), node.fringe.end(),
               std::back_inserter(all));
    scan.thinner.Thin(context, scan.surface.Scan(context, node, kThinHalo, all));
  }
}

namespace {

// Calls cut_out(number, tile_ijk) for the node's tiles, in Morton order, and appends the results that have voxels.
template <class CutOut>
void AppendTiles(const TileContext& context, const TileNode& node, std::vector<TileBricks>& tiles, CutOut&& cut_out) {
  const int32_t count = 1 << 3 * node.level;
  for (int32_t n = 0; n < count && !context.stop.Stopped(); ++n) {
    Vec3i step{};  // Morton order, i most significant
    for (int bit = 0; bit < node.level; ++bit) {
      for (size_t m = 0; m < 3; ++m) step[m] |= (n >> (3 * bit + 2 - static_cast<int>(m)) & 1) << bit;
    }
    TileBricks tile = cut_out(static_cast<size_t>(n), node.tile_ijk + step);
    if (tile.bricks.empty()) continue;
    tile.progress = std::min(1.0, node.progress + node.share * (n + 1) / count);
    tiles.push_back(std::move(tile));
  }
}

}  // namespace

void DigitizeBlock(const TileContext& context, const TileNode& node, const Interior* interior, bool surface,
                   BlockScan& scan, std::vector<TileBricks>& tiles) {
  surface = surface && (!node.triangles.empty() || node.links > 0);
  if (surface) FindSurface(context, node, scan);
  if (interior != nullptr) scan.solid.Sort(context.mesh, node, context.stop);
  AppendTiles(context, node, tiles, [&](size_t number, const Vec3i& tile_ijk) {
    if (interior == nullptr) return scan.surface.voxels().CutOut(context, tile_ijk);
    return scan.solid.CutOut(context, *interior, number, tile_ijk, surface ? &scan.surface.voxels() : nullptr);
  });
}

void FindLinksOfBlock(const TileContext& context, const TileNode& node, const Interior* interior, LinkSide side,
                      BlockScan& scan, std::vector<TileBricks>& tiles) {
  scan.links.Find(context, node);
  if (interior != nullptr) scan.solid.Sort(context.mesh, node, context.stop);
  AppendTiles(context, node, tiles, [&](size_t number, const Vec3i& tile_ijk) {
    TileBricks tile = scan.links.voxels().CutOut(context, tile_ijk);
    if (interior != nullptr && !tile.bricks.empty()) {
      KeepSide(side, scan.solid.RowsOf(*interior, number, tile_ijk), tile);
    }
    return tile;
  });
}

}  // namespace latvox
