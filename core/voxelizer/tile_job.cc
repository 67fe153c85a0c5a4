#include "core/voxelizer/tile_job.h"

#include <algorithm>
#include <cstdlib>
#include <iterator>

namespace latvox {

Vec3i ReachOf(const std::vector<Frame>& frames) {
  Vec3i reach{};
  for (const Frame& frame : frames) {
    for (size_t m = 0; m < 3; ++m) reach[m] = std::max(reach[m], std::abs(frame.q[m]));
  }
  return reach;
}

// Nearly all tiles can be thinned knowing kNearHalo steps around them; the rest are done again with all that may
// matter.
std::optional<TileBricks> DigitizeTile(const TileContext& context, const Vec3i& tile_ijk,
                                       const std::vector<uint32_t>& triangles, const std::vector<uint32_t>& fringe,
                                       TileScan& scan) {
  scan.Scan(context, tile_ijk, context.minimal ? kNearHalo : 0, triangles);
  if (context.minimal && !scan.Thin(context)) {
    std::vector<uint32_t> all;
    std::merge(triangles.begin(), triangles.end(), fringe.begin(), fringe.end(), std::back_inserter(all));
    scan.Scan(context, tile_ijk, kThinHalo, all);
    scan.Thin(context);
  }
  TileBricks out = scan.CutOut(context);
  if (out.bricks.empty() || context.cancelled) return std::nullopt;
  return out;
}

}  // namespace latvox
