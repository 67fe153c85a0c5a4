// The facts that all blocks of a job share.
#ifndef LATVOX_CORE_BLOCK_TILE_CONTEXT_H_
#define LATVOX_CORE_BLOCK_TILE_CONTEXT_H_

#include <cstdint>
#include <vector>

#include "core/base/stop_signal.h"
#include "core/base/uninitialized.h"
#include "core/brick/brick.h"
#include "core/digitize/principal_scan.h"
#include "core/snap/snap.h"
#include "core/supercover/supercover.h"
#include "core/thin/thin.h"
#include "core/tile/tile_links.h"

namespace latvox {

// The first halo of thinning, in steps around a tile. It is nearly always large enough.
inline constexpr int32_t kNearHalo = 2;

struct TileContext {
  const SnappedMesh& mesh;
  const std::vector<ScanFrame>& frames;
  const Supercover* supercover;  // null unless the request asks for one; a supercover is not thinned
  Vec3i reach;                   // per axis, the largest |q| of the frames, or the supercover's ScanReach()
  bool minimal;                  // whether to thin
  const TileLinks& links;        // links or supercover of tiny triangles, if many are; set before the first tile
  // Which triangles are tiny, if nodes list these, too; else empty.
  const UninitializedVector<uint8_t>& is_tiny;
  IndexBox region;  // local voxels outside are not delivered
  StopSignal stop;
  Vec3i overlap{};  // voxels around a block, per axis, that its scan decides as well

  // The steps around a block within which its scan looks for the first voxels of lines, if it does not thin.
  int32_t ScanHalo() const { return supercover != nullptr && supercover->near_cells() != nullptr ? 1 : 0; }

  // The distance from a tile, per axis in voxels, within which triangles may matter to it: at first, and in any case.
  Vec3i NearMargin() const { return reach * (minimal ? kNearHalo + 1 : 1) + overlap; }
  Vec3i FarMargin() const { return reach * (minimal ? kThinHalo + 1 : 1) + overlap; }
};

}  // namespace latvox

#endif  // LATVOX_CORE_BLOCK_TILE_CONTEXT_H_
