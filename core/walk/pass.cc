#include "core/walk/pass.h"

#include <cstring>

#include "core/tile/cut_out.h"

namespace latvox {

TileBricks WalkScan::CutOut(const TileContext& context, const Vec3i& tile_ijk, const TileRows& points) {
  static_assert(sizeof(TileRows) == size_t{kTileSide} * kTileSide * kTileSide / 8);
  std::memcpy(bits.words().data(), points.data(), sizeof(TileRows));
  const Vec3i low = tile_ijk * kTileSide;
  return latvox::CutOut(BitsLayout(low, {}), bits, low, context.region, context.mesh.base_ijk);
}

bool WalkPass::HasLinksNear(const TileNode& node) const {
  if (context_.links.empty()) return false;
  const int32_t side = 1 << node.level;
  for (int32_t n = 0; n < 27; ++n) {
    const Vec3i at = node.tile_ijk + Vec3i{n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1} * side;
    const Vec3i relative = at - context_.links.first_tile();
    if (relative[0] < 0 || relative[1] < 0 || relative[2] < 0) continue;
    if (context_.links.CountIn(at, node.level) > 0) return true;
  }
  return false;
}

}  // namespace latvox
