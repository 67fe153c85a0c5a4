#include "core/voxelizer/tile_job.h"

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

// Nearly all blocks can be thinned knowing kNearHalo steps around them; the rest are done again with all that may
// matter.
void DigitizeBlock(const TileContext& context, const TileNode& node, TileScan& scan, std::vector<TileBricks>& tiles) {
  scan.Scan(context, node, context.minimal ? kNearHalo : 0, node.triangles);
  std::vector<uint32_t> all;
  if (context.minimal && !scan.Thin(context)) {
    std::merge(node.triangles.begin(), node.triangles.end(), node.fringe.begin(), node.fringe.end(),
               std::back_inserter(all));
    scan.Scan(context, node, kThinHalo, all);
    scan.Thin(context);
  }
  const int32_t count = 1 << 3 * node.level;
  for (int32_t n = 0; n < count && !context.cancelled; ++n) {
    Vec3i step{};  // Morton order, i most significant
    for (int bit = 0; bit < node.level; ++bit) {
      for (size_t m = 0; m < 3; ++m) step[m] |= (n >> (3 * bit + 2 - static_cast<int>(m)) & 1) << bit;
    }
    TileBricks tile = scan.CutOut(context, node.tile_ijk + step);
    if (tile.bricks.empty()) continue;
    tile.progress = std::min(1.0, node.progress + node.share * (n + 1) / count);
    tiles.push_back(std::move(tile));
  }
}

}  // namespace latvox
