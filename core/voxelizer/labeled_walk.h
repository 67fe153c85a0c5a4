// The enclosed sets of all labels of a mesh: a walk for each label, over its own triangles.
#ifndef LATVOX_CORE_VOXELIZER_LABELED_WALK_H_
#define LATVOX_CORE_VOXELIZER_LABELED_WALK_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/stop_signal.h"
#include "core/base/vec.h"
#include "core/block/scan_pool.h"
#include "core/brick/brick.h"
#include "core/brick/filled_tiles.h"
#include "core/solid/labels.h"
#include "core/tree/tile_tree.h"
#include "core/voxelizer/exact_plan.h"
#include "core/walk/facts.h"
#include "core/walk/joint_cubes.h"
#include "core/walk/pass.h"
#include "core/walk/walk.h"

namespace latvox {

// Returns the walk of a plan with one. It refers to the plan. Errors: as Walk::Make.
//   kept    the triangles that tiles need to know; nullopt: all
//   scans   see WalkPass
absl::StatusOr<std::unique_ptr<const Walk>> MakeWalk(const ExactPlan& plan, std::optional<std::vector<uint32_t>> kept,
                                                     ScanPool<WalkScan>& scans, StopSignal stop);

// The memory of one thread, which it reuses from tile to tile.
struct LabeledWalkScan {
  WalkScan of_label;
  TileRows taken;               // the points of the labels so far
  Labels::Groups near, fringe;  // the places of the node's triangles in their labels' meshes, by rank
  // Where labels meet: the points at which runs of a label, or of no label, begin; and the labels of these, row by row.
  TileRows starts;
  std::vector<uint32_t> of_starts = {};
  std::vector<uint32_t> ranks = {};  // of the labels that may hold points of the tile
};

// Threads: after Make, any.
class LabeledWalk : public FilledTiles {
 public:
  // Makes a plan and a walk for each label, one after the other. Each takes about the time of the surface's scan of its
  // triangles, and a fixed time. The plan, which must have labels and outlive this, is that of the whole mesh.
  // Errors: CANCELLED.
  static absl::StatusOr<std::unique_ptr<const LabeledWalk>> Make(const ExactPlan& plan, StopSignal stop);

  bool MayHold(const Vec3i& tile_ijk, int level) const override;

  // As Walk has it.
  bool NeedsTriangles() const {
    return std::ranges::any_of(labels_, [](const OfLabel& of_label) { return of_label.walk->NeedsTriangles(); });
  }

  // Appends the tile of a node, with its labels, if it has voxels.
  //   node   a tile of a tree with the plan's margins and, if NeedsTriangles, all triangles of the mesh
  void FindTile(const TileContext& context, const TileNode& node, LabeledWalkScan& scan,
                std::vector<TileBricks>& tiles) const;

  const WalkFacts& facts() const { return facts_; }

 private:
  struct OfLabel {
    std::unique_ptr<ExactPlan> plan;
    std::unique_ptr<const Walk> walk;
  };

  explicit LabeledWalk(const ExactPlan& plan);

  absl::Status AddLabel(SnappedMesh mesh, std::span<const uint32_t> triangles, size_t packed_bytes,
                        ScanPool<WalkScan>& scans, StopSignal stop);
  Labels::Groups ByRank(std::span<const uint32_t> triangles, StopSignal stop) const;
  void AddFacts(uint32_t label, const WalkFacts& facts);

  const ExactPlan& plan_;
  std::vector<uint32_t> places_;  // of each triangle in its label's mesh
  std::vector<OfLabel> labels_;   // by rank
  JointCubes cubes_;              // of all labels' walks, which have the same cube of tiles
  size_t leaks_ = 0;              // labels that are not closed around the point of the request
  WalkFacts facts_;
};

// The memory of a label, and for each triangle: its copy, its place, and its part of the links of tiny triangles, which
// take up to 4.5 MiB for each 16,384 triangles of a label.
inline constexpr uint64_t kLabeledWalkBytesPerLabel = 64 << 10, kLabeledWalkBytesPerTriangle = 20 + 288;

}  // namespace latvox

#endif  // LATVOX_CORE_VOXELIZER_LABELED_WALK_H_
