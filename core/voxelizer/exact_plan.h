// What an exact job decides, and finds out about its mesh, before its first tile.
#ifndef LATVOX_CORE_VOXELIZER_EXACT_PLAN_H_
#define LATVOX_CORE_VOXELIZER_EXACT_PLAN_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "core/attributes/plan.h"
#include "core/band/inside.h"
#include "core/band/plan.h"
#include "core/base/stop_signal.h"
#include "core/base/uninitialized.h"
#include "core/block/tile_context.h"
#include "core/brick/tile_order.h"
#include "core/digitize/principal_scan.h"
#include "core/lattice/frame.h"
#include "core/request/solid.h"
#include "core/snap/snap.h"
#include "core/supercover/supercover.h"
#include "core/tile/tile_links.h"
#include "core/voxelizer/voxelizer.h"
#include "core/voxelizer/world_box.h"

namespace latvox {

// What is asked for, of a mesh that has been snapped.
struct ExactInput {
  SnappedMesh mesh;
  std::vector<Frame> frames;  // of the request's separability
  std::unique_ptr<const Supercover>
      supercover;  // this and the next two: null, and nullopt, unless the request asks for them
  std::optional<BandPlan> band;
  std::optional<CarriedAttributes> attributes;
  IndexBox region;                 // local voxels to deliver, within mesh.box
  std::optional<WorldBox> bounds;  // of these, deliver only the ones within
};

struct ExactPlan {
  ExactInput input;
  std::vector<ScanFrame> scan_frames;
  std::optional<Solid> solid;
  bool minimal = false;                       // whether to thin
  Vec3i reach{};                              // see TileContext
  Vec3i near_margin{}, far_margin{};          // of the tree: see TileTree
  bool has_large_tiles = false;               // of megabytes each
  bool is_fine = false;                       // whether the mesh is: what follows is of a fine one
  std::unique_ptr<TileLinks> links;           // that tiny triangles cross, if most are tiny
  UninitializedVector<uint8_t> is_tiny;       // see TileContext
  std::optional<std::vector<uint32_t>> kept;  // triangles that tiles are to know of, ascending; nullopt: all
  JobFacts facts;
  std::optional<CornerLines> corner_lines;  // of a signed band
  Shard shard;
  TileSpan span;  // of what is delivered

  // For the blocks of the job that `job` stops. Refers to this.
  TileContext Context(StopSignal job) const {
    return {input.mesh, scan_frames, input.supercover.get(), reach, minimal, *links, is_tiny, input.region, job};
  }
};

// Of a fine mesh, facts and crossings of tiny triangles are found in one pass.
//   creation   stops this function, not the job
// Errors: INVALID_ARGUMENT if the band is signed and the mesh not closed; CANCELLED.
absl::StatusOr<std::unique_ptr<ExactPlan>> MakeExactPlan(ExactInput input, const VoxelRequest& request,
                                                         StopSignal creation);

}  // namespace latvox

#endif  // LATVOX_CORE_VOXELIZER_EXACT_PLAN_H_
