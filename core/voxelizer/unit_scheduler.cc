#include "core/voxelizer/unit_scheduler.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/base/metered.h"
#include "core/brick/tile_order.h"

namespace latvox {
namespace {

// A subtree of at most this size becomes one unit of parallel work. It is large enough to keep the pipeline's serial
// part small, and small enough to keep threads busy and memory bounded.
constexpr int kMaxUnitLevel = 2;  // 4^3 tiles
constexpr size_t kMaxUnitTriangles = 4096;
constexpr int kMaxSolidUnitLevel = 1;  // tiles may be full, of 512 bricks each

// Blocks of 2^3 tiles are digitized together, and share the voxels between them. Larger blocks' bits would not fit a
// core's cache. Blocks are smaller where there would be too few for the threads: a surface meets some 2 * 4^n of 8^n
// blocks.
int BlockLevel(int tree_level) {
  constexpr int kBlocksPerThread = 4;  // IsSmall splits the last ones of these
  const int threads = oneapi::tbb::this_task_arena::max_concurrency();
  return tree_level > 0 && (threads == 1 || 2 << 2 * (tree_level - 1) >= kBlocksPerThread * threads) ? 1 : 0;
}

// Guided self-scheduling [Polychronopoulos and Kuck 1987]: no thread may be busy with the last unit while others have
// nothing to do. Units have up to twice a thread's part of the rest, because single tiles take longer.
bool IsSmall(const TileNode& node) {
  constexpr double kRounding = 1e-9;  // of the shares and their sums
  const int threads = oneapi::tbb::this_task_arena::max_concurrency();
  return node.level == 0 || threads == 1 || node.share * threads <= 2 * (1 - node.progress) + kRounding;
}

}  // namespace

UnitScheduler::UnitScheduler(const ExactPlan& plan, std::optional<std::vector<uint32_t>> kept, StopSignal job)
    : plan_(plan),
      job_(job),
      tile_base_(Shifted(plan.input.mesh.base_ijk, kTileBits)),
      tree_(plan.input.mesh, 0, plan.near_margin, plan.far_margin, plan.input.region, job),
      kept_(std::move(kept)) {
  if (plan.is_fine) tree_.AddLinks(*plan.links);
}

void UnitScheduler::AddFilled(const FilledTiles& filled) {
  filled_ = &filled;
  tree_.KeepEmpty();
}

// A tile has up to kMostBytesOfVoxel * 2^18 bytes of fields.
bool UnitScheduler::IsUnit(const TileNode& node) const {
  if (plan_.has_large_tiles) return tree_.IsLeaf(node);
  const int max_level = filled_ != nullptr ? kMaxSolidUnitLevel : kMaxUnitLevel;
  if (!tree_.IsLeaf(node) && (node.level > max_level || node.triangles.size() + node.links > kMaxUnitTriangles)) {
    return false;
  }
  return IsSmall(node);
}

// Returns a tile's place in the canonical order.
uint64_t UnitScheduler::NumberOf(const Vec3i& tile_ijk) const {
  return TileNumber(tile_ijk - plan_.facts.first_tile_ijk);
}

bool UnitScheduler::IsLeftOut(const TileNode& node) const {
  if (node.triangles.empty() && node.links == 0 &&
      !(filled_ != nullptr && filled_->MayHold(node.tile_ijk, node.level))) {
    return true;
  }
  if (const auto& bounds = plan_.input.bounds) {
    const Vec3i low = (node.tile_ijk + tile_base_) * kTileSide;
    const int32_t side = kTileSide << node.level;
    if (bounds->Misses({low, low + Vec3i{side, side, side}})) return true;
  }
  return !plan_.span.Meets(NumberOf(node.tile_ijk + tile_base_), uint64_t{1} << 3 * node.level);
}

// The pipeline waits for this function. So many threads split large nodes, and many nodes at a time.
std::optional<TileNode> UnitScheduler::Next() {
  if (!std::exchange(started_, true)) {
    // A tile of a band has megabytes, and so has one of a filled set with fields.
    const bool has_full_tiles = plan_.input.band || ((plan_.solid || plan_.input.walk) && plan_.input.fields);
    if (!has_full_tiles) tree_.SetLeafLevel(BlockLevel(tree_.level()));
    // Isolated, so that the waiting thread does not take up a unit meanwhile.
    oneapi::tbb::this_task_arena::isolate([&] { todo_ = tree_.Top(std::exchange(kept_, std::nullopt)); });
    std::reverse(todo_.begin(), todo_.end());
  }
  while (!todo_.empty() && !job_.Stopped()) {
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

void UnitScheduler::PutBack(std::vector<TileNode> units) {
  std::move(units.rbegin(), units.rend(), std::back_inserter(todo_));
}

// Replaces the next nodes that are no units, as many as there are threads, by their children.
void UnitScheduler::SplitNext() {
  const size_t count = std::min(todo_.size(), static_cast<size_t>(oneapi::tbb::this_task_arena::max_concurrency()));
  const size_t kept = todo_.size() - count;
  std::vector<std::vector<TileNode>> parts(count);
  oneapi::tbb::this_task_arena::isolate([&] {  // as in Next
    MeteredFor(oneapi::tbb::blocked_range<size_t>(0, count), [&](const auto& numbers) {
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

}  // namespace latvox
