// Decisions of an exact job, and facts about its mesh, before its first tile.
#ifndef LATVOX_CORE_VOXELIZER_EXACT_PLAN_H_
#define LATVOX_CORE_VOXELIZER_EXACT_PLAN_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "core/band/plan.h"
#include "core/base/stop_signal.h"
#include "core/base/uninitialized.h"
#include "core/block/tile_context.h"
#include "core/block/tile_job.h"
#include "core/brick/tile_order.h"
#include "core/digitize/principal_scan.h"
#include "core/fields/plan.h"
#include "core/fields/triangle_index.h"
#include "core/lattice/frame.h"
#include "core/request/links.h"
#include "core/request/solid.h"
#include "core/snap/finer_mesh.h"
#include "core/snap/snap.h"
#include "core/solid/labels.h"
#include "core/supercover/supercover.h"
#include "core/tile/tile_links.h"
#include "core/voxelizer/voxelizer.h"
#include "core/voxelizer/world_box.h"
#include "core/walk/plan.h"

namespace latvox {

// A request for a mesh that has been snapped.
struct ExactInput {
  SnappedMesh mesh;
  std::vector<Frame> frames;  // for the request's separability
  // The next four are null or nullopt unless the request needs them.
  std::unique_ptr<const Supercover> supercover;
  std::optional<BandPlan> band;
  std::optional<WalkPlan> walk;
  std::optional<FieldPlan> fields;
  IndexBox region;                 // local voxels to deliver, within mesh.box
  std::optional<WorldBox> bounds;  // deliver only voxels of `region` within these
};

// Why any thread can compute tiles in any grouping: a tile needs only the plan, the interior of a solid, and the
// triangles within its far margin. That margin covers all voxels that can affect thinning in the tile (kThinHalo
// steps), and one more step for the triangles that reach these. Both margins cover the reach of the mesh's numbers. A
// block that is thinned within the near margin reports whether that was enough (core/thin/thin.h). `kept` leaves out
// only triangles that cross no lattice line, and tiny ones, whose links or cells are in `links`. No tile changes the
// plan.
struct ExactPlan {
  ExactInput input;
  std::vector<ScanFrame> scan_frames;
  std::optional<Solid> solid;
  std::optional<Labels> labels;               // of a labeled set
  std::optional<Links> link_ends;             // a set of these
  bool minimal = false;                       // whether to thin
  bool needs_inside = false;                  // whether tiles need to know on which side of the mesh their voxels are
  Vec3i reach{}, overlap{};                   // see TileContext
  Vec3i near_margin{}, far_margin{};          // of the tree, see TileTree
  bool has_large_tiles = false;               // of megabytes each
  bool is_fine = false;                       // whether the mesh is fine; the next members belong to a fine mesh
  std::unique_ptr<TileLinks> links;           // links or supercover of tiny triangles, if there are many
  UninitializedVector<uint8_t> is_tiny;       // see TileContext
  std::optional<std::vector<uint32_t>> kept;  // the triangles that tiles need to know, ascending; nullopt: all
  JobFacts facts;
  std::unique_ptr<TriangleIndex> index;  // for fields that need it
  std::optional<FinerMesh> finer;        // for a fraction
  Shard shard;
  TileSpan span;  // the tiles to deliver

  // The local voxels that the job looks at: a walk comes by all.
  const IndexBox& scanned() const { return input.walk ? input.mesh.box : input.region; }

  // Returns the context of the job's blocks, which `job` stops. It refers to this plan.
  TileContext Context(StopSignal job) const {
    return {input.mesh, scan_frames, input.supercover.get(), reach, minimal,
            *links,     is_tiny,     input.region,           job,   overlap};
  }

  // The same for the links of blocks, whatever the set.
  TileContext LinkContext(StopSignal job) const {
    return {input.mesh, scan_frames, nullptr, ReachOf(input.frames), false, *links, is_tiny, input.region, job};
  }

  // Whether voxels carry fields of links.
  bool HasLinkFields() const { return input.fields && !input.fields->fields.OfLinks().empty(); }

  // Whether voxels carry a fraction.
  bool HasFraction() const { return input.fields && input.fields->cell; }

  // Whether fields come from the triangles near a tile.
  bool NeedsNearTriangles() const { return input.fields && input.fields->near_reach; }

  // Whether fields need the triangles that a tile's node lists.
  bool FieldsNeedTriangles() const { return HasLinkFields() || HasFraction() || NeedsNearTriangles() || needs_inside; }
};

// For a fine mesh, one pass finds the facts and the crossings of tiny triangles.
//   creation   stops this function, not the job
// Errors: INVALID_ARGUMENT if the set is no solid, ExactPlan::needs_inside, and the mesh has no inside; those of
// MakeLabels and MakeFinerMesh; CANCELLED.
absl::StatusOr<std::unique_ptr<ExactPlan>> MakeExactPlan(ExactInput input, const VoxelRequest& request,
                                                         StopSignal creation);

}  // namespace latvox

#endif  // LATVOX_CORE_VOXELIZER_EXACT_PLAN_H_
