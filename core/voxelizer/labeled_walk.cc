#include "core/voxelizer/labeled_walk.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <functional>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "core/brick/label_runs.h"

namespace latvox {
namespace {

// A walk looks at blocks of 2^3 tiles in a cube with more tiles than 2^3 of these, which keep many threads busy.
constexpr int kLeastLevelOfBlocks = 2;

constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();

// Calls f(n) for the numbers below `count` until it is stopped.
template <class F>
void ForEachUntilStopped(size_t count, StopSignal stop, const F& f) {
  constexpr size_t kPiece = 4096;  // numbers between two looks at the stop signal
  for (size_t n = 0; n < count && (n % kPiece != 0 || !stop.Stopped()); ++n) f(n);
}

// The part of a mesh with some of its triangles. It shares the vertices of all, and has the whole mesh's box. So all
// labels' cubes of tiles are the same, and the nodes of one tree fit all walks.
SnappedMesh PartOf(const SnappedMesh& mesh, std::span<const uint32_t> triangles, StopSignal stop) {
  std::vector<std::array<uint32_t, 3>> corners(triangles.size());
  ForEachUntilStopped(triangles.size(), stop, [&](size_t n) { corners[n] = mesh.triangles[triangles[n]]; });
  return {mesh.base_ijk, mesh.vertices_lat, std::move(corners), mesh.box};
}

// Whether a lattice point lies in the box around the triangles.
bool SurroundsPoint(const SnappedMesh& mesh, const Vec3i& ijk, StopSignal stop) {
  constexpr int32_t kMost = std::numeric_limits<int32_t>::max();
  Vec3i low{kMost, kMost, kMost}, high{-kMost, -kMost, -kMost};
  ForEachUntilStopped(mesh.triangles.size(), stop, [&](size_t t) {
    for (const Vec3i& corner : mesh.TriangleAt(t)) {
      for (size_t m = 0; m < 3; ++m) {
        low[m] = std::min(low[m], corner[m]);
        high[m] = std::max(high[m], corner[m]);
      }
    }
  });
  for (size_t m = 0; m < 3; ++m) {
    const int64_t at = int64_t{ijk[m]} * kLatticeUnit;  // the point may be far away
    if (at < low[m] || at > high[m]) return false;
  }
  return true;
}

// Notes where the runs of these points of a row begin and end. All of them have this label. No other label gets them,
// so a run stays as it is.
void AddRuns(size_t row, uint64_t points, uint32_t label, LabeledWalkScan& scan) {
  scan.starts[row] |= points ^ points << 1;
  for (uint64_t firsts = points & ~(points << 1); firsts != 0; firsts &= firsts - 1) {
    scan.of_starts[row * kTileSide + static_cast<size_t>(std::countr_zero(firsts))] = label;
  }
}

// Gives the points of `rows` that no label has yet to this one. Returns whether labels meet in the tile so far.
//   is_mixed, last   as returned, and the label of the points so far unless it is mixed
bool Take(const TileRows& rows, uint32_t label, bool is_mixed, uint32_t& last, LabeledWalkScan& scan) {
  bool is_new = false;
  for (size_t row = 0; row < rows.size() && !is_new; ++row) is_new = (rows[row] & ~scan.taken[row]) != 0;
  if (!is_new) return is_mixed;
  const bool is_first = last == kNoLabel;
  if (!is_first && !is_mixed) {
    scan.starts.fill(0);
    scan.of_starts.resize(rows.size() * kTileSide);
    for (size_t row = 0; row < rows.size(); ++row) AddRuns(row, scan.taken[row], last, scan);
  }
  for (size_t row = 0; row < rows.size(); ++row) {
    if (!is_first) AddRuns(row, rows[row] & ~scan.taken[row], label, scan);
    scan.taken[row] |= rows[row];
  }
  last = label;
  return !is_first;
}

// The runs of a tile where labels meet.
void SetRuns(const LabeledWalkScan& scan, LabelRuns& labels) {
  labels.clear();
  labels.starts.reserve(scan.taken.size() + 1);
  for (size_t row = 0; row < scan.taken.size(); ++row) {
    labels.starts.push_back(static_cast<uint32_t>(labels.runs.size()));
    for (uint64_t firsts = scan.starts[row] | 1; firsts != 0; firsts &= firsts - 1) {
      const int k = std::countr_zero(firsts);
      const bool has_label = (scan.taken[row] >> k & 1) != 0;
      labels.runs.push_back(
          {static_cast<uint32_t>(k), has_label ? scan.of_starts[row * kTileSide + static_cast<size_t>(k)] : kNoLabel});
    }
  }
  labels.starts.push_back(static_cast<uint32_t>(labels.runs.size()));
}

}  // namespace

absl::StatusOr<std::unique_ptr<const Walk>> MakeWalk(const ExactPlan& plan, std::optional<std::vector<uint32_t>> kept,
                                                     ScanPool<WalkScan>& scans, StopSignal stop) {
  const SnappedMesh& mesh = plan.input.mesh;
  const int level = TileCubeLevel(mesh.box) > kLeastLevelOfBlocks ? 1 : 0;
  TileTree tree(mesh, level, plan.near_margin, plan.far_margin, mesh.box, stop);
  if (plan.is_fine) tree.AddLinks(*plan.links);
  tree.KeepEmpty();
  return Walk::Make(plan.Context(stop), *plan.input.walk, tree, std::move(kept), scans);
}

LabeledWalk::LabeledWalk(const ExactPlan& plan)
    : plan_(plan),
      places_(plan.input.mesh.triangles.size()),
      cubes_(Shifted(plan.input.mesh.box.min, kTileBits), TileCubeLevel(plan.input.mesh.box)) {}

absl::StatusOr<std::unique_ptr<const LabeledWalk>> LabeledWalk::Make(const ExactPlan& plan, StopSignal stop) {
  const SnappedMesh& mesh = plan.input.mesh;
  const Labels& labels = *plan.labels;
  const Labels::Groups groups = labels.ByRank(stop);
  std::unique_ptr<LabeledWalk> made(new LabeledWalk(plan));
  size_t packed_bytes = kMostPackedBytes;
  ScanPool<WalkScan> scans;  // new ones for each label would take a third of the time of a thousand small labels
  for (size_t rank = 0; rank < labels.numbers.size(); ++rank) {
    const std::span<const uint32_t> triangles = groups.Of(rank);
    auto status = made->AddLabel(PartOf(mesh, triangles, stop), triangles, packed_bytes, scans, stop);
    if (!status.ok()) return status;
    const Walk& walk = *made->labels_.back().walk;
    packed_bytes -= walk.packed_bytes();
    made->AddFacts(labels.numbers[rank], walk.facts());
  }
  std::ranges::sort(made->facts_.labels, {}, &LabelWalkFacts::label);
  return made;
}

// A label's plan is one of an enclosed set without labels and fields.
absl::Status LabeledWalk::AddLabel(SnappedMesh mesh, std::span<const uint32_t> triangles, size_t packed_bytes,
                                   ScanPool<WalkScan>& scans, StopSignal stop) {
  const ExactInput& whole = plan_.input;
  WalkPlan walk = *whole.walk;
  walk.most_packed_bytes = packed_bytes;
  if (walk.start && (leaks_ == kMostLeaks || !SurroundsPoint(mesh, *walk.start, stop))) walk.start = std::nullopt;
  WalkSet set;
  set.surface.minimal = plan_.minimal;
  auto plan = MakeExactPlan({.mesh = std::move(mesh),
                             .frames = whole.frames,
                             .supercover = nullptr,
                             .band = std::nullopt,
                             .walk = std::move(walk),
                             .fields = std::nullopt,
                             .region = whole.region,
                             .bounds = std::nullopt},
                            VoxelRequest{.set = set}, stop);
  if (!plan.ok()) return plan.status();
  const std::optional<std::vector<uint32_t>> kept = std::exchange((*plan)->kept, std::nullopt);
  ForEachUntilStopped(triangles.size(), stop,
                      [&](size_t n) { places_[triangles[n]] = kept ? kNone : static_cast<uint32_t>(n); });
  ForEachUntilStopped(kept ? kept->size() : 0, stop, [&](size_t n) { places_[triangles[(*kept)[n]]] = (*kept)[n]; });
  auto made = MakeWalk(**plan, kept, scans, stop);
  if (!made.ok()) return made.status();
  const std::optional<Leak>& leak = (*made)->facts().leak;
  if (leak && leak->kind != Leak::kNone) ++leaks_;
  (*made)->AddTo(cubes_, static_cast<uint32_t>(labels_.size()));
  labels_.push_back({*std::move(plan), *std::move(made)});
  return absl::OkStatus();
}

void LabeledWalk::AddFacts(uint32_t label, const WalkFacts& facts) {
  facts_.labels.push_back({label, facts.cavities, facts.points, facts.leak});
  facts_.cavities += facts.cavities;
  facts_.points += facts.points;
  facts_.largest.insert(facts_.largest.end(), facts.largest.begin(), facts.largest.end());
  std::ranges::sort(facts_.largest, std::greater());
  facts_.largest.resize(std::min(facts_.largest.size(), kMostCavities));
}

bool LabeledWalk::MayHold(const Vec3i& tile_ijk, int level) const {
  if (level >= JointCubes::kLeastLevel) return cubes_.MayHold(tile_ijk, level);
  return cubes_.AnyAt(tile_ijk, [&](uint32_t rank) { return labels_[rank].walk->MayHold(tile_ijk, level); });
}

// The places of the triangles that their labels keep, ascending within each rank. Once stopped, they are incomplete.
Labels::Groups LabeledWalk::ByRank(std::span<const uint32_t> triangles, StopSignal stop) const {
  const std::vector<uint16_t>& ranks = plan_.labels->of_triangles;
  Labels::Groups groups{{}, std::vector<size_t>(plan_.labels->numbers.size() + 1)};
  ForEachUntilStopped(triangles.size(), stop, [&](size_t n) {
    if (places_[triangles[n]] != kNone) ++groups.begins[ranks[triangles[n]] + size_t{1}];
  });
  std::partial_sum(groups.begins.begin(), groups.begins.end(), groups.begins.begin());
  groups.order.resize(groups.begins.back());
  if (stop.Stopped()) return groups;
  std::vector<size_t> next(groups.begins.begin(), groups.begins.end() - 1);
  ForEachUntilStopped(triangles.size(), stop, [&](size_t n) {
    const uint32_t t = triangles[n];
    if (places_[t] != kNone) groups.order[next[ranks[t]]++] = places_[t];
  });
  return groups;
}

// From the highest priority down, each label gets the points that are left.
void LabeledWalk::FindTile(const TileContext& context, const TileNode& node, LabeledWalkScan& scan,
                           std::vector<TileBricks>& tiles) const {
  assert(node.level == 0);  // tiles with fields are found one by one
  scan.taken.fill(0);
  bool is_sorted = false, is_mixed = false;
  uint32_t last = kNoLabel;
  scan.ranks.clear();
  cubes_.AnyAt(node.tile_ijk, [&](uint32_t rank) {
    if (labels_[rank].walk->MayHold(node.tile_ijk, 0)) scan.ranks.push_back(rank);
    return false;
  });
  std::ranges::sort(scan.ranks);
  for (const uint32_t rank : scan.ranks) {
    const auto& [plan, walk] = labels_[rank];
    TileNode of_label{node.tile_ijk, 0, {}, {}, 0, 0};
    if (walk->NeedsTriangles(node.tile_ijk)) {
      if (!std::exchange(is_sorted, true)) {
        scan.near = ByRank(node.triangles, context.stop);
        scan.fringe = ByRank(node.fringe, context.stop);
      }
      const std::span<const uint32_t> near = scan.near.Of(rank), fringe = scan.fringe.Of(rank);
      of_label.triangles.assign(near.begin(), near.end());
      of_label.fringe.assign(fringe.begin(), fringe.end());
    }
    bool has_walls = false;
    walk->FindTile(plan->Context(context.stop), of_label, node.tile_ijk, scan.of_label, has_walls);
    if (context.stop.Stopped()) return;
    is_mixed = Take(scan.of_label.reached, plan_.labels->numbers[rank], is_mixed, last, scan);
    if (std::ranges::all_of(scan.taken, [](uint64_t row) { return row == ~uint64_t{0}; })) break;
  }
  TileBricks tile = scan.of_label.CutOut(context, node.tile_ijk, scan.taken);
  if (tile.bricks.empty()) return;
  if (is_mixed) {
    SetRuns(scan, tile.labels);
  } else {
    tile.labels.runs = {{0, last}};
  }
  tile.progress = std::min(1.0, node.progress + node.share);
  tiles.push_back(std::move(tile));
}

}  // namespace latvox
