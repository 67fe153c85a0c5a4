#include "core/walk/walk.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/status_payload.h"
#include "core/walk/growth.h"

namespace latvox {
namespace {

constexpr uint64_t kFullRow = ~uint64_t{0};

const TileRows& FullRows() {
  static const TileRows rows = [] {
    TileRows all;
    all.fill(kFullRow);
    return all;
  }();
  return rows;
}

absl::Status Cancelled() { return absl::CancelledError("voxelization cancelled"); }

std::string Shown(const Vec3i& ijk) { return absl::StrFormat("%d,%d,%d", ijk[0], ijk[1], ijk[2]); }

uint64_t PointsIn(const IndexBox& box) {
  uint64_t points = 1;
  for (size_t m = 0; m < 3; ++m) points *= static_cast<uint64_t>(std::max(box.max[m] - box.min[m], 0));
  return points;
}

absl::Status SeedError(const std::string& why, const Vec3i& seed) {
  return WithField(absl::InvalidArgumentError(absl::StrCat("connected.seed: ", why)), "connected.seed", Shown(seed));
}

// The walk from the seed got outside, by this way.
std::string WayOut(const Leak& leak) {
  if (leak.kind != Leak::kFound) return "";
  const auto& [x, y, z] = leak.narrowest_world;
  return absl::StrFormat(" through an opening around %g,%g,%g, whose middle is %g from the mesh", x, y, z, leak.room);
}

}  // namespace

Walk::Walk(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames, const WalkPlan& plan, int level)
    : mesh_(mesh), frames_(frames), plan_(plan), graph_(Shifted(mesh.box.min, kTileBits), level, mesh.box) {}

absl::StatusOr<std::unique_ptr<const Walk>> Walk::Make(const TileContext& context, const WalkPlan& plan,
                                                       const TileTree& tree, std::optional<std::vector<uint32_t>> kept,
                                                       ScanPool<WalkScan>& scans) {
  std::unique_ptr<Walk> walk(new Walk(context.mesh, context.frames, plan, tree.level()));
  WalkPass pass(context, plan, tree, scans);
  if (absl::Status status = walk->Run(context, pass, kept); !status.ok()) return status;
  return walk;
}

absl::Status Walk::Run(const TileContext& context, WalkPass& pass, const std::optional<std::vector<uint32_t>>& kept) {
  pass.Run(
      kept, [this](const Vec3i& tile_ijk, int level) { graph_.AddCube(tile_ijk, level); },
      [this](const Vec3i& tile_ijk, WalkScan& scan) { Look(tile_ijk, scan); });
  if (context.stop.Stopped()) return Cancelled();
  graph_.Unite();
  const std::vector<uint64_t> volumes = graph_.Volumes();
  facts_.cavities = volumes.size();
  facts_.points = std::accumulate(volumes.begin(), volumes.end(), uint64_t{0});
  facts_.largest.assign(volumes.begin(),
                        volumes.begin() + static_cast<ptrdiff_t>(std::min(volumes.size(), kMostCavities)));
  if (absl::Status status = FindStart(pass, kept, context.stop); !status.ok()) return status;
  if (plan_.ball) KeepReached(pass, kept, context.stop);
  return context.stop.Stopped() ? Cancelled() : absl::OkStatus();
}

// Finds the tile's pieces, and the one with the start.
void Walk::Look(const Vec3i& tile_ijk, WalkScan& scan) {
  const HaloBox box(tile_ijk, plan_.steps.reach);
  const bool may_be_cube = plan_.steps.slack == Vec3i{};
  if (may_be_cube && !scan.walls.MayMeet(box)) return graph_.AddCube(tile_ijk, 0);
  scan.walls.WallsIn(box, scan.rows);
  const bool is_free = std::all_of(scan.rows.begin(), scan.rows.end(), [](WideRow row) { return row == 0; });
  if (may_be_cube && is_free) return graph_.AddCube(tile_ijk, 0);
  TilePieces pieces = scan.pieces.Find(plan_.steps, box, scan.rows, mesh_.box);
  if (plan_.start && Shifted(*plan_.start, kTileBits) == tile_ijk) {
    const Vec3i at = *plan_.start - box.low;
    const size_t row = box.RowOf(at[0], at[1]);
    start_in_wall_ = (scan.rows[row] >> at[2] & 1) != 0;
    if (!start_in_wall_) start_piece_ = scan.pieces.pieces().PieceAt(row, at[2]);
  }
  graph_.AddTile(tile_ijk, std::move(pieces));
  KeepPacked(tile_ijk, Pack(box, scan.pieces.pieces()));
}

void Walk::KeepPacked(const Vec3i& tile_ijk, PackedPieces packed) {
  const std::lock_guard lock(kept_mutex_);
  if (packed.empty() || packed_bytes_ + packed.size() > plan_.most_packed_bytes) {
    all_packed_ = false;
    return;
  }
  packed_bytes_ += packed.size();
  packed_[tile_ijk] = std::move(packed);
}

absl::Status Walk::FindStart(WalkPass& pass, const std::optional<std::vector<uint32_t>>& kept, StopSignal stop) {
  if (!plan_.start) return absl::OkStatus();
  const Vec3i seed = *plan_.start + mesh_.base_ijk, tile = Shifted(*plan_.start, kTileBits);
  if (start_in_wall_) {
    if (!plan_.from_seed) facts_.leak = Leak{.kind = Leak::kInWall, .from = seed, .path = {}};
    return !plan_.from_seed
               ? absl::OkStatus()
               : SeedError(absl::StrCat("the nearest lattice point, ", Shown(seed), ", lies in the surface",
                                        plan_.ball ? ", or within half of connected.close of the mesh" : ""),
                           seed);
  }
  uint32_t node = WalkGraph::kOutside;
  if (mesh_.box.Contains(*plan_.start)) {
    const WalkGraph::TileNodes* const nodes = graph_.FindTile(tile);
    node = nodes != nullptr ? nodes->first + start_piece_ : graph_.FindCube(tile, 0).value_or(WalkGraph::kOutside);
  }
  if (plan_.from_seed) origin_ = node;
  const bool gets_outside = graph_.IsConnected(node, WalkGraph::kOutside);
  if (plan_.from_seed && (plan_.allow_outside || !gets_outside)) return absl::OkStatus();
  Leak leak = gets_outside ? FindLeak(pass, kept, stop) : Leak{.path = {}};
  leak.from = seed;
  if (stop.Stopped()) return Cancelled();
  if (plan_.from_seed && !mesh_.box.Contains(*plan_.start)) {
    return SeedError(absl::StrCat("the nearest lattice point, ", Shown(seed),
                                  ", lies outside of the mesh's box; allow_outside allows it"),
                     seed);
  }
  if (plan_.from_seed) {
    return SeedError(
        absl::StrCat("the walk from the nearest lattice point, ", Shown(seed), ", gets outside", WayOut(leak),
                     "; connected.close may close it, and connected.allow_outside allows it"),
        seed);
  }
  facts_.leak = std::move(leak);
  return absl::OkStatus();
}

Leak Walk::FindLeak(WalkPass& pass, const std::optional<std::vector<uint32_t>>& kept, StopSignal stop) const {
  Leak leak{.kind = Leak::kBoxTooLarge, .path = {}};
  leak.box_points = PointsIn(mesh_.box);
  if (leak.box_points > kMostLeakPoints) return leak;
  leak.kind = Leak::kFound;
  if (!mesh_.box.Contains(*plan_.start)) {  // it is outside already
    leak.path = {*plan_.start + mesh_.base_ijk};
    leak.narrowest = leak.path.front();
  } else {
    const Vec3i side = mesh_.box.max - mesh_.box.min;
    std::vector<uint8_t> clearance(leak.box_points, 1);
    pass.Run(
        kept, [](const Vec3i&, int) {},
        [&](const Vec3i& tile_ijk, WalkScan& scan) {
          const HaloBox box(tile_ijk, plan_.steps.reach);
          scan.walls.WallsIn(box, scan.rows);
          for (size_t row = 0; row < scan.reached.size(); ++row) {
            auto walls = static_cast<uint64_t>(scan.rows[box.RowOfTile(row)] >> box.halo[2]);
            for (; walls != 0; walls &= walls - 1) {
              const Vec3i ijk =
                  tile_ijk * kTileSide + Vec3i{static_cast<int32_t>(row >> kTileBits),
                                               static_cast<int32_t>(row & (kTileSide - 1)), LowestBit(walls)};
              if (!mesh_.box.Contains(ijk)) continue;
              const Vec3i at = ijk - mesh_.box.min;
              clearance[static_cast<size_t>((int64_t{at[0]} * side[1] + at[1]) * side[2] + at[2])] = 0;
            }
          }
        });
    std::vector<Frame> frames;
    for (const ScanFrame& scan : frames_) frames.push_back(scan.frame);
    Vec3i narrowest = *plan_.start;
    leak.path = FindWayOut(frames, mesh_.box, clearance, *plan_.start, stop, narrowest);
    leak.narrowest = narrowest + mesh_.base_ijk;
    for (Vec3i& ijk : leak.path) ijk = ijk + mesh_.base_ijk;
    leak.room = DistanceFromMesh(mesh_, plan_.grid.lattice, narrowest, stop);
  }
  leak.narrowest_world = Apply(plan_.grid.lattice.basis(), ToDouble(leak.narrowest)) + plan_.grid.origin;
  leak.steps = leak.path.size() - (leak.path.empty() ? 0 : 1);
  if (leak.path.size() > kMostLeakSteps) {
    const auto middle = std::find(leak.path.begin(), leak.path.end(), leak.narrowest) - leak.path.begin();
    const auto most = static_cast<ptrdiff_t>(kMostLeakSteps), size = static_cast<ptrdiff_t>(leak.path.size());
    const ptrdiff_t first = std::clamp<ptrdiff_t>(middle - most / 2, 0, size - most);
    leak.path = std::vector<Vec3i>(leak.path.begin() + first, leak.path.begin() + first + most);
  }
  return leak;
}

// Keeps the reached points of all tiles. The walls are found again only if the pieces of some tile are not at hand.
void Walk::KeepReached(WalkPass& pass, const std::optional<std::vector<uint32_t>>& kept, StopSignal stop) {
  if (!all_packed_) {
    pass.Run(
        kept, [](const Vec3i&, int) {}, [this](const Vec3i& tile_ijk, WalkScan& scan) { Keep(tile_ijk, scan); });
  } else {
    WalkScan scan;
    for (const auto& [tile_ijk, packed] : packed_) {
      if (stop.Stopped()) return;
      Keep(tile_ijk, scan);
    }
  }
  packed_ = {};
  packed_bytes_ = 0;
}

// Keeps the reached points of a tile that has some, and others.
void Walk::Keep(const Vec3i& tile_ijk, WalkScan& scan) {
  const WalkGraph::TileNodes* const nodes = graph_.FindTile(tile_ijk);
  if (nodes == nullptr || AllReached(*nodes, false)) return;
  auto rows = std::make_unique<TileRows>();
  ReadReached(tile_ijk, *nodes, scan, *rows);
  const std::lock_guard lock(kept_mutex_);
  kept_[tile_ijk] = std::move(rows);
}

bool Walk::AllReached(const WalkGraph::TileNodes& nodes, bool reached) const {
  for (uint32_t piece = 0; piece < nodes.count; ++piece) {
    if (IsReached(nodes.first + piece) != reached) return false;
  }
  return true;
}

// Finds the reached points of a tile with pieces, before they grow. Precondition: the scan has the walls around it, if
// NeedsWalls.
void Walk::ReadReached(const Vec3i& tile_ijk, const WalkGraph::TileNodes& nodes, WalkScan& scan, TileRows& rows) const {
  if (const auto packed = packed_.find(tile_ijk); packed != packed_.end()) {
    const auto is_reached = [&](uint32_t piece) { return piece < nodes.count && IsReached(nodes.first + piece); };
    return Unpack(packed->second, is_reached, rows);
  }
  const HaloBox box(tile_ijk, plan_.steps.reach);
  scan.walls.WallsIn(box, scan.rows);
  if (AllReached(nodes, true)) {
    for (size_t row = 0; row < rows.size(); ++row) {
      rows[row] = ~static_cast<uint64_t>(scan.rows[box.RowOfTile(row)] >> box.halo[2]);
    }
    return;
  }
  scan.pieces.FindOnly(plan_.steps, box, scan.rows);
  for (size_t row = 0; row < rows.size(); ++row) {
    WideRow reached = 0;
    for (const FreeRun& run : scan.pieces.pieces().RunsOf(box.RowOfTile(row))) {
      if (IsReached(nodes.first + run.piece)) reached |= FirstBits(run.last + 1) & ~FirstBits(run.first);
    }
    rows[row] = static_cast<uint64_t>(reached >> box.halo[2]);
  }
}

// With `close`: the reached points of a tile, before they grow; null: none.
const TileRows* Walk::ReachedIn(const Vec3i& tile_ijk) const {
  if (const auto kept = kept_.find(tile_ijk); kept != kept_.end()) return kept->second.get();
  if (graph_.FindTile(tile_ijk) != nullptr) return nullptr;
  const uint32_t node = graph_.FindCube(tile_ijk, 0).value_or(WalkGraph::kOutside);
  return IsReached(node) ? &FullRows() : nullptr;
}

bool Walk::MayHold(const Vec3i& tile_ijk, int level) const {
  const std::optional<uint32_t> cube = graph_.FindCube(tile_ijk, level);
  if (!cube) return true;
  return plan_.from_seed ? IsReached(*cube) || plan_.ball : !IsReached(*cube);
}

void Walk::AddTo(JointCubes& cubes, uint32_t rank) const {
  graph_.ForEachTile([&](const Vec3i& tile_ijk) { cubes.Add(rank, tile_ijk, 0); });
  graph_.ForEachCube([&](const Vec3i& tile_ijk, int level, uint32_t node) {
    if (!IsReached(node)) cubes.Add(rank, tile_ijk, level);
  });
}

// Finds the set's points in a tile.
//   nodes   null: it has no pieces, and no walls
void Walk::FindRows(const Vec3i& tile_ijk, const WalkGraph::TileNodes* nodes, WalkScan& scan, StopSignal stop,
                    TileRows& rows) const {
  if (plan_.ball) {
    rows.fill(0);
    plan_.ball->Grow([&](const Vec3i& beside) { return ReachedIn(tile_ijk + beside); }, stop, rows);
  } else if (nodes == nullptr) {
    const bool is_reached = IsReached(graph_.FindCube(tile_ijk, 0).value_or(WalkGraph::kOutside));
    rows.fill(is_reached ? kFullRow : 0);
  } else {
    ReadReached(tile_ijk, *nodes, scan, rows);
  }
  if (!plan_.from_seed) {
    for (uint64_t& row : rows) row = ~row;
  }
  if (nodes == nullptr || (!plan_.ball && (plan_.with_surface || plan_.from_seed))) return;
  const HaloBox box(tile_ijk, plan_.steps.reach);
  scan.walls.SurfaceIn(box, scan.rows);
  for (size_t row = 0; row < rows.size(); ++row) {
    const auto surface = static_cast<uint64_t>(scan.rows[box.RowOfTile(row)] >> box.halo[2]);
    rows[row] = plan_.with_surface ? rows[row] | surface : rows[row] & ~surface;
  }
}

void Walk::FindTile(const TileContext& context, const TileNode& node, const Vec3i& tile_ijk, WalkScan& scan,
                    bool& has_walls) const {
  const WalkGraph::TileNodes* const nodes = graph_.FindTile(tile_ijk);
  if (NeedsTriangles(tile_ijk) && !std::exchange(has_walls, true)) scan.walls.Scan(context, nullptr, node);
  if (!context.stop.Stopped()) FindRows(tile_ijk, nodes, scan, context.stop, scan.reached);
}

void Walk::FindTiles(const TileContext& context, const TileNode& node, WalkScan& scan,
                     std::vector<TileBricks>& tiles) const {
  bool has_walls = false;
  const int32_t count = 1 << 3 * node.level;
  for (int32_t n = 0; n < count && !context.stop.Stopped(); ++n) {
    const Vec3i tile_ijk = node.tile_ijk + Vec3i{n >> 2 & 1, n >> 1 & 1, n & 1};
    FindTile(context, node, tile_ijk, scan, has_walls);
    if (context.stop.Stopped()) return;
    TileBricks tile = scan.CutOut(context, tile_ijk, scan.reached);
    if (tile.bricks.empty()) continue;
    tile.progress = std::min(1.0, node.progress + node.share * (n + 1) / count);
    tiles.push_back(std::move(tile));
  }
}

}  // namespace latvox
