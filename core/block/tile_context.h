// What all blocks of a job have in common.
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

// The steps around a tile that thinning looks at first, which nearly always decides.
inline constexpr int32_t kNearHalo = 2;

struct TileContext {
  const SnappedMesh& mesh;
  const std::vector<ScanFrame>& frames;
  const Supercover* supercover;  // if that is asked for; else null. It is not thinned
  Vec3i reach;                   // per axis, the largest |q| of the frames, or the supercover's margin
  bool minimal;                  // whether to thin
  const TileLinks& links;        // of tiny triangles, if most are tiny; set before the first tile
  // Which triangles these are, if nodes list them, too, else empty.
  const UninitializedVector<uint8_t>& is_tiny;
  IndexBox region;  // local voxels outside are not delivered
  StopSignal stop;

  // How far, per axis, triangles may lie outside of a tile and still matter to it, in voxels: at first, and at all.
  Vec3i NearMargin() const { return reach * (minimal ? kNearHalo + 1 : 1); }
  Vec3i FarMargin() const { return reach * (minimal ? kThinHalo + 1 : 1); }
};

}  // namespace latvox

#endif  // LATVOX_CORE_BLOCK_TILE_CONTEXT_H_
