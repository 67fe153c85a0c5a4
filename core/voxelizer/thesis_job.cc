#include "core/voxelizer/thesis_job.h"

#include <utility>
#include <vector>

#include "core/base/cpu_meter.h"
#include "core/base/sort.h"
#include "core/brick/tile_order.h"
#include "core/thesis/thesis.h"
#include "core/triangles/surface_facts.h"
#include "core/voxelizer/job_facts.h"
#include "core/voxelizer/shard.h"

namespace latvox {
namespace {

// Returns the part of the set within `region` (ijk) and `bounds` as tiles, without tiles outside of `span`. low_tile is
// the first tile of the order.
std::vector<TileBricks> TilesOf(const VoxelSet& voxels, const IndexBox& region, const std::optional<WorldBox>& bounds,
                                const Vec3i& low_tile, const TileSpan& span, StopSignal stop) {
  const auto tile_of = [](const Brick& brick) { return Shifted(brick.brick_ijk, kTileBits - kBrickBits); };
  std::vector<Brick> bricks = voxels.Bricks(stop);
  std::vector<std::pair<uint64_t, size_t>> order;  // bricks by the numbers of their tiles, then by their old places
  for (size_t n = 0; n < bricks.size() && !stop.Stopped(); ++n) {
    ClipBrick(region, bricks[n]);
    if (CountVoxels(bricks[n].mask) == 0) continue;
    const uint64_t number = TileNumber(tile_of(bricks[n]) - low_tile);
    if (span.Contains(number)) order.emplace_back(number, n);
  }
  Sort(order, stop);
  std::vector<TileBricks> tiles;
  for (const auto& [number, n] : order) {
    if (stop.Stopped()) return {};
    const Brick& brick = bricks[n];
    const Vec3i tile_ijk = tile_of(brick);
    if (tiles.empty() || tiles.back().tile_ijk != tile_ijk) tiles.push_back({tile_ijk, {}});
    tiles.back().bricks.push_back(brick);
    tiles.back().voxels += CountVoxels(brick.mask);
  }
  if (bounds) {
    for (TileBricks& tile : tiles) bounds->Clip(tile);
    std::erase_if(tiles, [](const TileBricks& tile) { return tile.bricks.empty(); });
  }
  for (size_t n = 0; n < tiles.size(); ++n) {
    tiles[n].progress = static_cast<double>(n + 1) / static_cast<double>(tiles.size());
  }
  return tiles;
}

class ThesisJob : public VoxelizeJob {
 public:
  ThesisJob(SnappedMesh mesh, const Lattice& lattice, const VoxelRequest& request,
            const std::optional<WorldBox>& bounds, const JobFacts& facts, const TileSpan& span)
      : mesh_(std::move(mesh)), lattice_(lattice), request_(request), bounds_(bounds), facts_(facts), span_(span) {}

  const JobFacts& facts() const override { return facts_; }
  const JobTotals& totals() const override { return totals_; }
  void Cancel() override { stop_.Stop(); }
  double CpuSeconds() const override { return cpu_.Seconds(); }
  absl::StatusOr<Verdict> Verify(const VoxelSet& voxels) const override {
    const CpuMeter::Scope scope(cpu_);
    return CountTunnels(mesh_, lattice_.frames(request_.separability), voxels, stop_.Signal());
  }

  absl::StatusOr<bool> Advance(const Sink& sink) override {
    if (!computed_) {
      if (auto status = Compute(); !status.ok()) return status;
    }
    for (bool paused = false; !paused && delivered_ < tiles_.size() && !stop_.Stopped(); ++delivered_) {
      totals_.Add(tiles_[delivered_]);
      paused = !sink(std::move(tiles_[delivered_]));
    }
    if (stop_.Stopped()) return absl::CancelledError("voxelization cancelled");
    return delivered_ == tiles_.size();
  }

 private:
  absl::Status Compute() {
    const CpuMeter::Scope scope(cpu_);
    if (facts_.index_box) {
      const auto voxels =
          VoxelizeByThesis(mesh_, lattice_, request_.separability, request_.algorithm(), stop_.Signal());
      if (!voxels.ok()) return voxels.status();
      tiles_ = TilesOf(*voxels, *facts_.index_box, bounds_, facts_.first_tile_ijk, span_, stop_.Signal());
    }
    computed_ = true;
    return absl::OkStatus();
  }

  const SnappedMesh mesh_;
  const Lattice lattice_;
  const VoxelRequest request_;
  StopSource stop_;
  mutable CpuMeter cpu_;
  bool computed_ = false;
  std::vector<TileBricks> tiles_;  // in canonical order; a delivered tile is moved away
  size_t delivered_ = 0;
  const std::optional<WorldBox> bounds_;
  const JobFacts facts_;
  const TileSpan span_;
  JobTotals totals_;
};

}  // namespace

std::unique_ptr<VoxelizeJob> MakeThesisJob(SnappedMesh mesh, const Lattice& lattice, const VoxelRequest& request,
                                           const IndexBox& region, const std::optional<WorldBox>& bounds,
                                           StopSignal creation) {
  const JobFacts facts = FactsOfJob(mesh, FactsOf(mesh, creation), region, bounds);
  const TileSpan span = SpanOf(request.part, mesh, lattice.frames(request.separability), region, bounds, creation);
  return std::make_unique<ThesisJob>(std::move(mesh), lattice, request, bounds, facts, span);
}

}  // namespace latvox
