#include "core/voxelizer/exact_job.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_pipeline.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <iterator>
#include <span>
#include <utility>

#include "core/band/band_scan.h"
#include "core/block/attribute_tiles.h"
#include "core/block/scan_pool.h"
#include "core/block/tile_job.h"
#include "core/brick/tile_order.h"
#include "core/tiny/fine_pass.h"
#include "core/tree/tile_tree.h"
#include "core/triangles/surface_facts.h"
#include "core/voxelizer/job_facts.h"
#include "core/voxelizer/shard.h"

namespace latvox {
namespace {

// A subtree becomes one unit of parallel work when it is this small: enough to keep the serial part of the pipeline
// small, little enough to keep threads busy and memory bounded.
constexpr int kMaxUnitLevel = 2;  // 4^3 tiles
constexpr size_t kMaxUnitTriangles = 4096;
constexpr int kMaxSolidUnitLevel = 1;  // tiles may be full, of 512 bricks each

using Unit = std::vector<TileBricks>;

// What the pipeline's last stage delivers, one unit after the other: it does no more than it must.
struct FinishedUnit {
  Unit tiles;
  std::vector<JobTotals> totals;  // of each tile
};

class ExactJob final : public VoxelizeJob {
 public:
  ExactJob(SnappedMesh mesh, std::vector<Frame> frames, std::unique_ptr<const Supercover> supercover,
           const std::optional<BandPlan>& band, std::optional<CarriedAttributes> attributes,
           const VoxelizeOptions& options, const IndexBox& region, const std::optional<WorldBox>& bounds,
           StopSignal stop)
      : mesh_(std::move(mesh)),
        frames_(std::move(frames)),
        scan_frames_(MakeScanFrames(frames_)),
        supercover_(std::move(supercover)),
        fineness_(supercover_ || band ? Fineness{} : FinenessOf(mesh_, scan_frames_)),
        edges_(Shifted(mesh_.box.min, kTileBits),
               options.minimal && !supercover_ ? ReachOf(frames_) * kNearHalo : Vec3i{}),
        context_{mesh_,
                 scan_frames_,
                 supercover_.get(),
                 supercover_ ? supercover_->Margin() : ReachOf(frames_),
                 options.minimal && !supercover_,
                 edges_,
                 is_tiny_,
                 region,
                 stop_.Signal()},
        attributes_(mesh_, std::move(attributes), stop_.Signal()),
        tree_(mesh_, 0, attributes_.AtLeastReach(band ? band->reach : context_.NearMargin()),
              attributes_.AtLeastReach(band ? band->reach : context_.FarMargin()), region, stop_.Signal()),
        fine_(SortOut(options, stop)),
        bounds_(bounds),
        facts_(FactsOfJob(mesh_, fine_ ? fine_->facts : FactsOf(mesh_, stop), region, bounds)),
        solid_(options.solid),
        band_(MakeBandContext(band, region, stop)),
        shard_(options.shard.value_or(Shard{})),
        span_(SpanOf(options, mesh_, frames_, region, bounds, stop)) {
    if (band) facts_.band_width = band->width;
  }

  ~ExactJob() override {
    if (!stop_.Stopped()) scans_.Leave();
  }
  ExactJob(const ExactJob&) = delete;
  ExactJob& operator=(const ExactJob&) = delete;

  const JobFacts& facts() const override { return facts_; }
  const JobTotals& totals() const override { return totals_; }
  void Cancel() override { stop_.Stop(); }
  absl::Status Prepare() override;
  absl::StatusOr<bool> Advance(const Sink& sink) override;
  absl::StatusOr<Verdict> Verify(const VoxelSet& voxels) const override {
    return CountTunnels(mesh_, frames_, voxels, stop_.Signal());
  }

 private:
  std::optional<FineTriangles> SortOut(const VoxelizeOptions& options, StopSignal stop);
  std::optional<BandContext> MakeBandContext(const std::optional<BandPlan>& plan, const IndexBox& region,
                                             StopSignal stop) const;
  bool IsUnit(const TileNode& node) const;
  bool IsSmall(const TileNode& node) const;
  uint64_t NumberOf(const Vec3i& tile_ijk) const;
  bool IsLeftOut(const TileNode& node) const;
  std::vector<TileNode> Top();
  void ClipFrom(size_t first, Unit& out) const;
  std::optional<TileNode> NextUnit();
  void SplitNext();
  void Process(const TileNode& node, Unit& out) const;
  void ScanLeaf(const TileNode& node, Unit& out) const;
  void Deliver(TileBricks tile, const JobTotals& totals, const Sink& sink, bool& paused);

  const SnappedMesh mesh_;
  const std::vector<Frame> frames_;
  const std::vector<ScanFrame> scan_frames_;
  const std::unique_ptr<const Supercover> supercover_;
  StopSource stop_;
  const Fineness fineness_;
  TileEdges edges_;
  UninitializedVector<uint8_t> is_tiny_;
  const TileContext context_;
  const AttributeTiles attributes_;
  TileTree tree_;
  std::optional<FineTriangles> fine_;  // if the mesh is fine
  mutable ScanPool<BlockScan> scans_;
  mutable ScanPool<BandScan> band_scans_;
  const std::optional<WorldBox> bounds_;
  JobFacts facts_;
  const std::optional<Solid> solid_;
  std::unique_ptr<const Interior> interior_;  // of a solid, once prepared
  const bool has_axes_ = HasAxes(frames_);
  const std::optional<BandContext> band_;
  const Vec3i tile_base_ = Shifted(mesh_.base_ijk, kTileBits);
  const Shard shard_;
  const TileSpan span_;  // of what is delivered
  bool started_ = false;
  std::vector<TileNode> todo_;  // once started, what is left of the tree, the next node last
  JobTotals totals_;
};

// Tiles are digitized by blocks of 2^3, which share what lies between them (larger blocks' bits would not fit a core's
// cache), unless that leaves too few blocks for the threads at hand: a surface meets some 2 * 4^n of 8^n blocks.
int BlockLevel(int tree_level) {
  constexpr int kBlocksPerThread = 4;  // of which IsSmall has the last ones taken apart
  const int threads = oneapi::tbb::this_task_arena::max_concurrency();
  return tree_level > 0 && (threads == 1 || 2 << 2 * (tree_level - 1) >= kBlocksPerThread * threads) ? 1 : 0;
}

// Of a fine mesh, facts and crossings of tiny triangles are found in one pass.
std::optional<FineTriangles> ExactJob::SortOut(const VoxelizeOptions& options, StopSignal stop) {
  if (!fineness_.few_touch && !fineness_.most_tiny) return std::nullopt;
  const Vec3i margin = context_.FarMargin();
  const IndexBox around{context_.region.min - margin, context_.region.max + margin};
  const bool list_tiny = options.solid || attributes_.wanted();
  return SortOutFine(mesh_, scan_frames_, fineness_, around, stop, edges_, list_tiny ? &is_tiny_ : nullptr);
}

std::optional<BandContext> ExactJob::MakeBandContext(const std::optional<BandPlan>& plan, const IndexBox& region,
                                                     StopSignal stop) const {
  if (!plan) return std::nullopt;
  std::optional<CornerLines> lines;
  if (plan->is_signed && facts_.closed) lines.emplace(mesh_, stop);
  return BandContext{mesh_, *plan, region, std::move(lines), stop_.Signal()};
}

// A band's tile has up to a megabyte of values, and one with attributes up to three.
bool ExactJob::IsUnit(const TileNode& node) const {
  if (band_ || attributes_.wanted()) return tree_.IsLeaf(node);
  const int max_level = interior_ ? kMaxSolidUnitLevel : kMaxUnitLevel;
  if (!tree_.IsLeaf(node) && (node.level > max_level || node.triangles.size() + node.edges > kMaxUnitTriangles)) {
    return false;
  }
  return IsSmall(node);
}

// No thread may be long at the last unit while the others have nothing to do: guided self-scheduling [Polychronopoulos
// and Kuck 1987], with units of up to twice a thread's part of what is left, for tiles by themselves take longer.
bool ExactJob::IsSmall(const TileNode& node) const {
  constexpr double kRounding = 1e-9;  // of shares and their sums
  const int threads = oneapi::tbb::this_task_arena::max_concurrency();
  return node.level == 0 || threads == 1 || node.share * threads <= 2 * (1 - node.progress) + kRounding;
}

absl::Status ExactJob::Prepare() {
  if (!solid_ || interior_) return absl::OkStatus();
  auto interior = MakeInterior(mesh_, *solid_, facts_.closed, context_.region, context_.stop, facts_.unbalanced_lines);
  if (!interior.ok()) return interior.status();
  interior_ = *std::move(interior);
  tree_.KeepEmpty();
  return absl::OkStatus();
}

// A tile's place in the canonical order.
uint64_t ExactJob::NumberOf(const Vec3i& tile_ijk) const { return TileNumber(tile_ijk - facts_.first_tile_ijk); }

// Whether none of a node's tiles is delivered.
bool ExactJob::IsLeftOut(const TileNode& node) const {
  if (node.triangles.empty() && node.edges == 0 && !(interior_ && interior_->MayHold(node.tile_ijk, node.level))) {
    return true;
  }
  if (bounds_) {
    const Vec3i low = (node.tile_ijk + tile_base_) * kTileSide;
    const int32_t side = kTileSide << node.level;
    if (bounds_->Misses({low, low + Vec3i{side, side, side}})) return true;
  }
  return !span_.Meets(NumberOf(node.tile_ijk + tile_base_), uint64_t{1} << 3 * node.level);
}

// The top of the tree, of triangles that can have voxels. The interior asks lines along an axis; and what meets no line
// may still be the nearest to a voxel, whose attributes it then has.
std::vector<TileNode> ExactJob::Top() {
  if (!fine_) return tree_.Top();
  tree_.AddEdges(edges_);
  std::vector<uint32_t> kept = std::move(fine_->kept);  // which is not kept any longer
  const bool all = (interior_ && !has_axes_) || attributes_.wanted();
  return all ? tree_.Top() : tree_.Top(std::move(kept));
}

// Takes the tree apart until its next part is one unit of work. The pipeline waits for that: hence large nodes are
// split by many threads, and many nodes at a time.
std::optional<TileNode> ExactJob::NextUnit() {
  if (!std::exchange(started_, true)) {
    if (!band_) tree_.SetLeafLevel(BlockLevel(tree_.level()));
    // Isolated, lest the thread that waits here take up a unit meanwhile.
    oneapi::tbb::this_task_arena::isolate([&] { todo_ = Top(); });
    std::reverse(todo_.begin(), todo_.end());
  }
  while (!todo_.empty() && !stop_.Stopped()) {
    if (IsLeftOut(todo_.back())) {
      todo_.pop_back();
      continue;
    }
    if (IsUnit(todo_.back())) {
      TileNode node = std::move(todo_.back());
      todo_.pop_back();
      return node;
    }
    SplitNext();
  }
  return std::nullopt;
}

// Puts the children of the next nodes, as many as there are threads, in their place, where nodes are no units.
void ExactJob::SplitNext() {
  const size_t count = std::min(todo_.size(), static_cast<size_t>(oneapi::tbb::this_task_arena::max_concurrency()));
  const size_t kept = todo_.size() - count;
  std::vector<std::vector<TileNode>> parts(count);
  oneapi::tbb::this_task_arena::isolate([&] {  // as in NextUnit
    oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<size_t>(0, count), [&](const auto& numbers) {
      for (size_t n = numbers.begin(); n < numbers.end(); ++n) {
        TileNode& node = todo_[kept + n];
        if (IsLeftOut(node)) continue;
        if (IsUnit(node)) {
          parts[n].push_back(std::move(node));
        } else {
          parts[n] = tree_.Children(node);
        }
      }
    });
  });
  todo_.resize(kept);
  for (std::vector<TileNode>& part : parts) std::move(part.rbegin(), part.rend(), std::back_inserter(todo_));
}

void ExactJob::Process(const TileNode& node, Unit& out) const {
  if (stop_.Stopped() || IsLeftOut(node)) return;
  if (!tree_.IsLeaf(node)) {
    for (const TileNode& child : tree_.Children(node)) Process(child, out);
    return;
  }
  const size_t first = out.size();
  ScanLeaf(node, out);
  ClipFrom(first, out);
  std::erase_if(out, [this](const TileBricks& tile) { return !span_.Contains(NumberOf(tile.tile_ijk)); });
  attributes_.Add(node.triangles, std::span(out).subspan(first));
}

// Leaves out what is not within the bounds.
void ExactJob::ClipFrom(size_t first, Unit& out) const {
  if (!bounds_) return;
  for (size_t n = first; n < out.size(); ++n) bounds_->Clip(out[n]);
  std::erase_if(out, [](const TileBricks& tile) { return tile.bricks.empty(); });
}

void ExactJob::ScanLeaf(const TileNode& node, Unit& out) const {
  if (band_) {
    std::unique_ptr<BandScan> scan = band_scans_.Take();
    TileBricks tile = scan->Scan(*band_, node.tile_ijk, node.triangles);
    band_scans_.Give(std::move(scan));
    tile.progress = std::min(1.0, node.progress + node.share);
    if (!tile.bricks.empty()) out.push_back(std::move(tile));
    return;
  }
  std::unique_ptr<BlockScan> scan = scans_.Take();
  DigitizeBlock(context_, node, interior_.get(), !solid_ || solid_->surface, *scan, out);
  scans_.Give(std::move(scan));
}

// Progress is counted over the whole: of a shard it is estimated to begin and to end where equal parts do.
void ExactJob::Deliver(TileBricks tile, const JobTotals& totals, const Sink& sink, bool& paused) {
  tile.progress = std::clamp(tile.progress * shard_.count - shard_.index, 0.0, 1.0);
  totals_.Add(totals);
  if (!sink(std::move(tile))) paused = true;
}

// Units enter and leave the pipeline in order, which makes the stream a function of the request; its tokens bound the
// tiles in flight.
absl::StatusOr<bool> ExactJob::Advance(const Sink& sink) {
  using oneapi::tbb::filter_mode;
  using oneapi::tbb::flow_control;
  if (absl::Status status = Prepare(); !status.ok()) return status;
  // In small jobs, small units wait for a large one before them: with two in flight a thread, other threads waited,
  // too. In large ones more of them would keep others waiting when the sink pauses. Units of a band or with attributes
  // have megabytes each, and so may those that are not thinned.
  constexpr int kSmallJobLevel = 5;  // 32 tiles a side
  const bool may_be_large = band_ || attributes_.wanted() || !context_.minimal || tree_.level() > kSmallJobLevel;
  const size_t per_thread = may_be_large ? 2 : 4;
  const size_t tokens = per_thread * static_cast<size_t>(oneapi::tbb::this_task_arena::max_concurrency());
  std::atomic<bool> stop = false;
  oneapi::tbb::parallel_pipeline(
      tokens, oneapi::tbb::make_filter<void, TileNode>(filter_mode::serial_in_order, [&](flow_control& flow) {
                auto unit = stop ? std::nullopt : NextUnit();
                if (unit) return *std::move(unit);
                flow.stop();
                return TileNode{};
              }) & oneapi::tbb::make_filter<TileNode, FinishedUnit>(filter_mode::parallel, [&](const TileNode& node) {
                FinishedUnit unit;
                Process(node, unit.tiles);
                unit.totals.resize(unit.tiles.size());
                for (size_t n = 0; n < unit.tiles.size(); ++n) unit.totals[n].Add(unit.tiles[n]);
                return unit;
              }) & oneapi::tbb::make_filter<FinishedUnit, void>(filter_mode::serial_in_order, [&](FinishedUnit unit) {
                bool paused = false;
                for (size_t n = 0; n < unit.tiles.size(); ++n) {
                  if (!stop_.Stopped()) Deliver(std::move(unit.tiles[n]), unit.totals[n], sink, paused);
                }
                if (paused) stop = true;
              }));
  if (stop_.Stopped()) return absl::CancelledError("voxelization cancelled");
  return todo_.empty();
}

}  // namespace

std::unique_ptr<VoxelizeJob> MakeExactJob(SnappedMesh mesh, const std::vector<Frame>& frames,
                                          std::unique_ptr<const Supercover> supercover,
                                          const std::optional<BandPlan>& band,
                                          std::optional<CarriedAttributes> attributes, const VoxelizeOptions& options,
                                          const IndexBox& region, const std::optional<WorldBox>& bounds,
                                          StopSignal stop) {
  return std::make_unique<ExactJob>(std::move(mesh), frames, std::move(supercover), band, std::move(attributes),
                                    options, region, bounds, stop);
}

}  // namespace latvox
