#include "core/voxelizer/exact_job.h"

#include <oneapi/tbb/parallel_pipeline.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <utility>
#include <vector>

#include "core/base/cpu_meter.h"
#include "core/block/fraction_tiles.h"
#include "core/block/solid_tiles.h"
#include "core/solid/labeled_interior.h"
#include "core/voxelizer/unit_scan.h"
#include "core/voxelizer/unit_scheduler.h"

namespace latvox {
namespace {

// The result of one unit, prepared so that the pipeline's last, serial stage has little to do.
struct FinishedUnit {
  TileNode unit;
  bool complete = false;  // it was not interrupted
  std::vector<TileBricks> tiles;
  std::vector<JobTotals> totals;  // for each tile
};

class ExactJob final : public VoxelizeJob {
 public:
  explicit ExactJob(std::unique_ptr<ExactPlan> plan)
      : plan_(std::move(plan)),
        units_(*plan_, std::exchange(plan_->kept, std::nullopt), stop_.Signal()),
        scan_(*plan_, units_, scan_stop_.Signal()) {}
  ~ExactJob() override { scan_.LeaveMemory(); }
  ExactJob(const ExactJob&) = delete;
  ExactJob& operator=(const ExactJob&) = delete;

  const JobFacts& facts() const override { return plan_->facts; }
  const JobTotals& totals() const override { return totals_; }
  void Cancel() override {
    stop_.Stop();
    scan_stop_.Stop();
  }
  void Interrupt() override { scan_stop_.Stop(); }
  absl::Status Prepare() override;
  absl::StatusOr<bool> Advance(const Sink& sink) override;
  double CpuSeconds() const override { return cpu_.Seconds(); }
  absl::StatusOr<Verdict> Verify(const VoxelSet& voxels) const override {
    const CpuMeter::Scope scope(cpu_);
    return CountTunnels(plan_->input.mesh, plan_->input.frames, voxels, stop_.Signal());
  }

 private:
  absl::Status PrepareWalk();
  absl::Status PrepareInterior();
  absl::Status PrepareFiner();
  size_t UnitsInFlight() const;
  FinishedUnit Finish(TileNode unit) const;
  bool Deliver(FinishedUnit unit, const Sink& sink);

  StopSource stop_;       // by Cancel
  StopSource scan_stop_;  // by Cancel or Interrupt
  mutable CpuMeter cpu_;
  const std::unique_ptr<ExactPlan> plan_;
  UnitScheduler units_;
  const UnitScan scan_;
  Prepared prepared_;
  JobTotals totals_;
};

// The walk looks at the whole mesh, whatever part is delivered.
absl::Status ExactJob::PrepareWalk() {
  const auto keep = [this](auto made, auto& kept) {
    if (!made.ok()) return made.status();
    kept = *std::move(made);
    plan_->facts.walk = kept->facts();
    units_.AddFilled(*kept);
    if (!kept->NeedsTriangles() && !plan_->FieldsNeedTriangles()) units_.DropTriangles();
    return absl::OkStatus();
  };
  ScanPool<WalkScan> scans;
  return plan_->labels ? keep(LabeledWalk::Make(*plan_, stop_.Signal()), prepared_.labeled_walk)
                       : keep(MakeWalk(*plan_, units_.kept(), scans, stop_.Signal()), prepared_.walk);
}

absl::Status ExactJob::Prepare() {
  if (plan_->input.walk && !prepared_.walk && !prepared_.labeled_walk) {
    const CpuMeter::Scope scope(cpu_);
    if (absl::Status status = PrepareWalk(); !status.ok()) return status;
  }
  if (absl::Status status = PrepareInterior(); !status.ok()) return status;
  return PrepareFiner();
}

absl::Status ExactJob::PrepareInterior() {
  if (prepared_.interior || !plan_->needs_inside) return absl::OkStatus();
  const CpuMeter::Scope scope(cpu_);
  JobFacts& facts = plan_->facts;
  if (!plan_->solid) {  // the mesh has an inside
    prepared_.interior =
        MakeClosedInterior(plan_->input.mesh, facts.interior_rule, plan_->input.region, stop_.Signal());
    return stop_.Stopped() ? absl::CancelledError("voxelization cancelled") : absl::OkStatus();
  }
  const SnappedMesh& mesh = plan_->input.mesh;
  auto interior =
      plan_->labels
          ? MakeLabeledInterior(mesh, *plan_->labels, *plan_->solid, plan_->HasFraction(), plan_->input.region,
                                stop_.Signal(), facts.interior_rule, facts.unbalanced_lines)
          : MakeInterior(mesh, *plan_->solid, plan_->HasFraction(), facts.closed, plan_->input.region, stop_.Signal(),
                         facts.interior_rule, facts.unbalanced_lines);
  if (!interior.ok()) return interior.status();
  prepared_.interior = *std::move(interior);
  units_.AddFilled(*prepared_.interior);
  return absl::OkStatus();
}

// The mesh has an inside, because a job without one ends before.
absl::Status ExactJob::PrepareFiner() {
  if (prepared_.finer || !plan_->HasFraction()) return absl::OkStatus();
  const CpuMeter::Scope scope(cpu_);
  const SnappedMesh& mesh = plan_->finer->mesh;
  const IndexBox points = FinerPointsOf(*plan_->input.fields->cell, *plan_->finer, plan_->input.region);
  const InteriorRule rule = plan_->facts.interior_rule;
  auto finer = plan_->solid && plan_->labels
                   ? MakeClosedLabeledInterior(mesh, *plan_->labels, rule, points, stop_.Signal())
                   : MakeClosedInterior(mesh, rule, points, stop_.Signal());
  if (stop_.Stopped()) return absl::CancelledError("voxelization cancelled");
  prepared_.finer = std::move(finer);
  return absl::OkStatus();
}

// In a small job, small units wait for a large one before them. With two units in flight for each thread, other threads
// waited, too. In a large job, more units in flight would keep others waiting when the sink pauses. Units of a band or
// with fields have megabytes each, and so may units that are not thinned.
size_t ExactJob::UnitsInFlight() const {
  constexpr int kSmallJobLevel = 5;  // 32 tiles a side
  const bool may_be_large = plan_->has_large_tiles || !plan_->minimal || units_.tree().level() > kSmallJobLevel;
  const size_t per_thread = may_be_large ? 2 : 4;
  return per_thread * static_cast<size_t>(oneapi::tbb::this_task_arena::max_concurrency());
}

FinishedUnit ExactJob::Finish(TileNode unit) const {
  const CpuMeter::Scope scope(cpu_);
  FinishedUnit finished{.unit = std::move(unit), .complete = false, .tiles = {}, .totals = {}};
  finished.tiles = scan_.Scan(finished.unit, prepared_);
  finished.complete = !scan_stop_.Stopped();
  if (!finished.complete) return finished;  // voxels may lack fields
  finished.totals.resize(finished.tiles.size());
  for (size_t n = 0; n < finished.tiles.size(); ++n) finished.totals[n].Add(finished.tiles[n]);
  return finished;
}

// Returns whether the sink wants more. Progress counts over the whole. A shard's beginning and end are estimated as if
// all parts were equal.
bool ExactJob::Deliver(FinishedUnit unit, const Sink& sink) {
  bool more = true;
  for (size_t n = 0; n < unit.tiles.size() && !stop_.Stopped(); ++n) {
    TileBricks& tile = unit.tiles[n];
    tile.progress = std::clamp(tile.progress * plan_->shard.count - plan_->shard.index, 0.0, 1.0);
    totals_.Add(unit.totals[n]);
    if (!sink(std::move(tile))) more = false;
  }
  return more;
}

// Units enter and leave the pipeline in order, so the stream is a function of the request: behind an incomplete unit,
// all go back. The pipeline's tokens bound the number of tiles in flight.
absl::StatusOr<bool> ExactJob::Advance(const Sink& sink) {
  using oneapi::tbb::filter_mode;
  using oneapi::tbb::flow_control;
  using oneapi::tbb::make_filter;
  scan_stop_.Reset();
  if (stop_.Stopped()) scan_stop_.Stop();  // after Reset, so that no Cancel is lost
  if (absl::Status status = Prepare(); !status.ok()) return status;
  std::atomic<bool> paused = false;
  std::vector<TileNode> returned;
  oneapi::tbb::parallel_pipeline(
      UnitsInFlight(), make_filter<void, TileNode>(filter_mode::serial_in_order, [&](flow_control& flow) {
                         const CpuMeter::Scope scope(cpu_);  // Next is isolated, so no unit is finished within
                         auto unit = paused || scan_stop_.Stopped() ? std::nullopt : units_.Next();
                         if (unit) return *std::move(unit);
                         flow.stop();
                         return TileNode{};
                       }) & make_filter<TileNode, FinishedUnit>(filter_mode::parallel, [&](TileNode node) {
                         return Finish(std::move(node));
                       }) & make_filter<FinishedUnit, void>(filter_mode::serial_in_order, [&](FinishedUnit unit) {
                         if (!unit.complete || !returned.empty()) {
                           returned.push_back(std::move(unit.unit));
                         } else if (!Deliver(std::move(unit), sink)) {
                           paused = true;
                         }
                       }));
  units_.PutBack(std::move(returned));
  if (stop_.Stopped()) return absl::CancelledError("voxelization cancelled");
  return units_.Done();
}

}  // namespace

std::unique_ptr<VoxelizeJob> MakeExactJob(std::unique_ptr<ExactPlan> plan) {
  return std::make_unique<ExactJob>(std::move(plan));
}

}  // namespace latvox
