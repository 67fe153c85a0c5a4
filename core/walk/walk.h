// Which points a walk reaches, and the tiles of a set that this decides.
//
// The walk is not walked. One pass over the tiles near the mesh finds the pieces of free points in each, and what
// pieces of neighboring tiles share. A union of pieces decides which belong together. Tiles far from the mesh are one
// node, and so are whole cubes of them. The memory is that of some numbers for each tile near the mesh. A tile that is
// delivered finds its walls and pieces again.
#ifndef LATVOX_CORE_WALK_WALK_H_
#define LATVOX_CORE_WALK_WALK_H_

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/status/statusor.h"
#include "core/block/tile_context.h"
#include "core/brick/brick.h"
#include "core/brick/filled_tiles.h"
#include "core/tree/tile_tree.h"
#include "core/walk/facts.h"
#include "core/walk/graph.h"
#include "core/walk/joint_cubes.h"
#include "core/walk/leak.h"
#include "core/walk/packed_pieces.h"
#include "core/walk/pass.h"
#include "core/walk/plan.h"

namespace latvox {

// Threads: after Make, any.
class Walk : public FilledTiles {
 public:
  // Finds which points the walk reaches. Takes about the time of the surface's scan, whatever part is delivered.
  //   context   of the delivered tiles; its stop signal is not used later
  //   tree      see WalkPass
  //   kept      see WalkPass
  //   scans     see WalkPass
  // All except `kept` and `scans` must outlive it. Errors: INVALID_ARGUMENT if the seed lies in a wall, or if the walk
  // from it gets outside though the request does not allow it; CANCELLED.
  static absl::StatusOr<std::unique_ptr<const Walk>> Make(const TileContext& context, const WalkPlan& plan,
                                                          const TileTree& tree,
                                                          std::optional<std::vector<uint32_t>> kept,
                                                          ScanPool<WalkScan>& scans);

  bool MayHold(const Vec3i& tile_ijk, int level) const override;

  // Adds where the walk may hold points: tiles near the mesh, and cubes of tiles off it. Precondition: it is not from a
  // seed.
  void AddTo(JointCubes& cubes, uint32_t rank) const;

  // Whether a delivered tile, or any, needs the triangles of its node: where pieces are not at hand.
  bool NeedsTriangles(const Vec3i& tile_ijk) const {
    return graph_.FindTile(tile_ijk) != nullptr && NeedsWalls(tile_ijk);
  }
  bool NeedsTriangles() const { return NeedsSurface() || !all_packed_; }

  // Finds the set's points in one of the node's tiles: scan.reached.
  //   has_walls   whether the scan has the node's walls already
  void FindTile(const TileContext& context, const TileNode& node, const Vec3i& tile_ijk, WalkScan& scan,
                bool& has_walls) const;

  // Appends the node's tiles that have voxels, as DigitizeBlock does.
  void FindTiles(const TileContext& context, const TileNode& node, WalkScan& scan,
                 std::vector<TileBricks>& tiles) const;

  const WalkFacts& facts() const { return facts_; }
  // Bytes of the pieces that it keeps: at most most_packed_bytes of the plan.
  size_t packed_bytes() const { return packed_bytes_; }

 private:
  Walk(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames, const WalkPlan& plan, int level);

  absl::Status Run(const TileContext& context, WalkPass& pass, const std::optional<std::vector<uint32_t>>& kept);
  void Look(const Vec3i& tile_ijk, WalkScan& scan);
  void KeepPacked(const Vec3i& tile_ijk, PackedPieces packed);
  // Whether delivered tiles need their surface, even if their pieces are at hand.
  bool NeedsSurface() const { return plan_.ball || (!plan_.with_surface && !plan_.from_seed); }
  // Whether a delivered tile with pieces needs the scan of its walls.
  bool NeedsWalls(const Vec3i& tile_ijk) const { return NeedsSurface() || !packed_.contains(tile_ijk); }
  absl::Status FindStart(WalkPass& pass, const std::optional<std::vector<uint32_t>>& kept, StopSignal stop);
  Leak FindLeak(WalkPass& pass, const std::optional<std::vector<uint32_t>>& kept, StopSignal stop) const;
  void KeepReached(WalkPass& pass, const std::optional<std::vector<uint32_t>>& kept, StopSignal stop);
  void Keep(const Vec3i& tile_ijk, WalkScan& scan);

  bool IsReached(uint32_t node) const { return graph_.IsConnected(node, origin_); }
  // Whether all of a tile's pieces are reached, or none of them is.
  bool AllReached(const WalkGraph::TileNodes& nodes, bool reached) const;
  void ReadReached(const Vec3i& tile_ijk, const WalkGraph::TileNodes& nodes, WalkScan& scan, TileRows& rows) const;
  const TileRows* ReachedIn(const Vec3i& tile_ijk) const;
  void FindRows(const Vec3i& tile_ijk, const WalkGraph::TileNodes* nodes, WalkScan& scan, StopSignal stop,
                TileRows& rows) const;

  const SnappedMesh& mesh_;
  const std::vector<ScanFrame>& frames_;
  const WalkPlan& plan_;
  WalkGraph graph_;
  bool start_in_wall_ = false;
  uint32_t start_piece_ = 0;               // of its tile, if that has pieces
  uint32_t origin_ = WalkGraph::kOutside;  // the node where the walk starts
  std::mutex kept_mutex_;
  // The pieces of tiles, up to most_packed_bytes of the plan. With `close`, only until the reached points are kept. The
  // choice of tiles does not change a set.
  absl::flat_hash_map<Vec3i, PackedPieces> packed_;
  size_t packed_bytes_ = 0;
  bool all_packed_ = true;
  // With `close`: the reached points of tiles that have some, and others.
  absl::flat_hash_map<Vec3i, std::unique_ptr<const TileRows>> kept_;
  static_assert(sizeof(TileRows) == kBytesPerReachedTile);
  WalkFacts facts_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_WALK_WALK_H_
