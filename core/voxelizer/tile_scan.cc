#include "core/voxelizer/tile_scan.h"

#include <algorithm>
#include <bit>

#include "absl/container/flat_hash_set.h"
#include "core/tile/cut_out.h"

namespace latvox {
namespace {

// Sets all bits but those of the box.
void SetOutside(const BitsLayout& layout, const IndexBox& box, TileBits& bits) {
  std::fill(bits.words().begin(), bits.words().end(), ~0U);
  for (int32_t i = box.min[0]; i < box.max[0]; ++i) {
    for (int32_t j = box.min[1]; j < box.max[1]; ++j) {
      uint32_t number = layout.NumberOf({i, j, box.min[2]});
      const uint32_t end = layout.NumberOf({i, j, box.max[2]});
      while (number < end) {
        const uint32_t next = std::min(end, (number | 31) + 1);
        const uint32_t from_here = ~0U << (number & 31), to_there = ~0U >> (31 - ((next - 1) & 31));
        bits.words()[number >> 5] &= ~(from_here & to_there);
        number = next;
      }
    }
  }
}

// Appends to `pairs` the voxels at `positions` of a list, with the triangles that put them there.
//   end   the member of Candidates::Run for that list
void AppendPairs(const NumberList& voxels, const NumberList& positions, const std::vector<Candidates::Run>& runs,
                 uint32_t Candidates::Run::*end, std::span<const uint32_t> triangles,
                 std::vector<VoxelTriangle>& pairs) {
  auto run = runs.begin();
  for (const uint32_t n : positions.view()) {
    while ((*run).*end <= n) ++run;
    pairs.push_back({voxels[n] & kNumberMask, triangles[run->first + (voxels[n] >> kNumberBits)]});
  }
}

}  // namespace

// Voxels outside of the box are unknown: their bits are set, so that they are neither looked at nor prove anything.
void TileScan::Scan(const TileContext& context, const TileNode& node, int32_t halo,
                    std::span<const uint32_t> triangles) {
  const Vec3i low = node.tile_ijk * kTileSide;
  const int32_t side = kTileSide << node.level;
  const IndexBox before = box_;
  const BitsLayout layout_before = layout_;
  block_ = {low, low + Vec3i{side, side, side}};
  box_ = {block_.min - context.reach * halo, block_.max + context.reach * halo};
  layout_ = BitsLayout(low, context.reach * (halo + 1), side);
  if (layout_.side != layout_before.side || box_.max - box_.min != before.max - before.min ||
      unknown_.words().size() != layout_.Words()) {
    unknown_ = incomplete_ = TileBits(layout_.Words());
    SetOutside(layout_, box_, unknown_);
    SetOutside(layout_, {box_.min + context.reach, box_.max - context.reach}, incomplete_);
  }
  surface_.words() = unknown_.words();
  candidates_.Clear();
  crossings_.Clear();
  triangles_ = triangles;
  if (context.fine) {
    others_.clear();
    FindTinyCrossings(context.mesh, triangles, context.frames, box_, layout_, context.cancelled, crossings_, others_);
    triangles_ = others_;
  }
  FindCandidates(context.mesh, triangles_, context.frames, box_, layout_, context.cancelled, candidates_);
  for (const uint32_t voxel : candidates_.nearer.view()) surface_.Set(voxel & kNumberMask);
  for (const uint32_t voxel : crossings_.nearer.view()) surface_.Set(voxel);
  AddRim(context);
}

// Calls f(voxel, star) for all pairs_ whose voxel is, or is not, in `bits` when their turn comes.
template <class F>
void TileScan::ForEachStar(const TileContext& context, const TileBits& bits, bool in_set, F&& f) {
  constexpr size_t kBatch = 64;  // what f does to `bits` spares the batches that follow
  StarEdges stars[kBatch];
  VoxelTriangle batch[kBatch];
  for (size_t n = 0; n < pairs_.size() && !context.cancelled;) {
    size_t size = 0;
    for (; n < pairs_.size() && size < kBatch; ++n) {
      batch[size] = pairs_[n];
      size += bits.Test(pairs_[n].voxel) == in_set ? 1 : 0;
    }
    FindStarEdges(context.mesh, context.frames, layout_, {batch, size}, stars);
    for (size_t m = 0; m < size; ++m) f(batch[m].voxel, stars[m]);
  }
}

// Most candidates of a triangle's rim are voxels that its neighbours have set.
void TileScan::AddRim(const TileContext& context) {
  pairs_.clear();
  rim_only_.clear();
  surface_.Find(candidates_.rim.view(), false, positions_);
  AppendPairs(candidates_.rim, positions_, candidates_.runs, &Candidates::Run::rim_end, triangles_, pairs_);
  ForEachStar(context, surface_, false, [&](uint32_t voxel, const StarEdges& star) {
    if (star.nearer == 0 || surface_.Test(voxel)) return;
    surface_.Set(voxel);
    rim_only_.push_back(voxel);
  });
}

// Evaluates the stars of pairs_ for thinning: voxels that prove essential leave rest_, edges within it are recorded.
void TileScan::AskStars(const TileContext& context) {
  ForEachStar(context, rest_, true, [&](uint32_t z, const StarEdges& star) {
    for (uint32_t bits = star.nearer; bits != 0; bits &= bits - 1) {
      const int n = std::countr_zero(bits);
      const int32_t step = layout_.StepOf(context.frames[static_cast<size_t>(n)].frame.q);
      const uint32_t end = z + static_cast<uint32_t>(star.forward >> n & 1 ? step : -step);
      if (!surface_.Test(end)) return rest_.Clear(z);
      if (rest_.Test(end)) edges_.push_back({z, end});
    }
  });
}

// What may be redundant becomes rest_. An edge whose farther end lies outside shows its nearer end essential; the edges
// along principal directions, which are at hand, do so for nearly all.
void TileScan::FindRest() {
  rest_.Resize(layout_.Words());  // empty
  maybe_.clear();
  // For a while, rest_ holds what tiny triangles show essential, of which all edges are at hand.
  surface_.Find(crossings_.farther.view(), false, closed_);
  for (const uint32_t n : closed_.view()) rest_.Set(crossings_.nearer[n]);
  rest_.Find(crossings_.nearer.view(), false, inner_);
  for (const uint32_t n : inner_.view()) maybe_.push_back(crossings_.nearer[n]);
  const auto add = [&](uint32_t voxel) {
    if (!rest_.Test(voxel)) maybe_.push_back(voxel);
  };
  surface_.Find(candidates_.farther.view(), true, open_);
  for (const uint32_t n : open_.view()) add(candidates_.nearer[n] & kNumberMask);
  for (const uint32_t voxel : rim_only_) add(voxel);
  for (const uint32_t n : closed_.view()) rest_.Clear(crossings_.nearer[n]);
  for (const uint32_t voxel : maybe_) rest_.Set(voxel);
  rest_.Find(candidates_.nearer.view(), true, positions_);
  for (const uint32_t n : positions_.view()) {
    if (!surface_.Test(candidates_.farther[n] & kNumberMask)) rest_.Clear(candidates_.nearer[n] & kNumberMask);
  }
}

// The members of rest_ all of whose edges are known, ascending.
std::vector<uint32_t> TileScan::Doubtful() const {
  std::vector<uint32_t> doubtful;
  for (const uint32_t voxel : maybe_) {
    if (rest_.Test(voxel) && !incomplete_.Test(voxel)) doubtful.push_back(voxel);
  }
  std::sort(doubtful.begin(), doubtful.end());
  doubtful.erase(std::unique(doubtful.begin(), doubtful.end()), doubtful.end());
  return doubtful;
}

// Of what FindRest leaves, the stars decide. Near the border of the box farther ends are unknown: of the voxels there,
// only those matter that are neighbours of a doubtful one.
bool TileScan::Thin(const TileContext& context) {
  FindRest();
  edges_.clear();
  pairs_.clear();
  AppendPairs(candidates_.nearer, open_, candidates_.runs, &Candidates::Run::crossed_end, triangles_, pairs_);
  rest_.Find(candidates_.rim.view(), true, positions_);
  AppendPairs(candidates_.rim, positions_, candidates_.runs, &Candidates::Run::rim_end, triangles_, pairs_);
  const auto border = std::partition(pairs_.begin(), pairs_.end(),
                                     [&](const VoxelTriangle& pair) { return !incomplete_.Test(pair.voxel); });
  std::vector<VoxelTriangle> at_border(border, pairs_.end());
  pairs_.erase(border, pairs_.end());
  AskStars(context);

  const std::vector<uint32_t> doubtful = Doubtful();
  absl::flat_hash_set<uint32_t> asked;
  for (const uint32_t voxel : doubtful) {
    for (const ScanFrame& scan : context.frames) {
      const auto step = static_cast<uint32_t>(layout_.StepOf(scan.frame.q));
      for (const uint32_t neighbour : {voxel + step, voxel - step}) {
        if (rest_.Test(neighbour) && incomplete_.Test(neighbour)) asked.insert(neighbour);
      }
    }
  }
  if (!asked.empty()) {
    std::erase_if(at_border, [&](const VoxelTriangle& pair) { return !asked.contains(pair.voxel); });
    pairs_ = std::move(at_border);
    AskStars(context);
  }
  for (const uint32_t n : inner_.view()) edges_.push_back({crossings_.nearer[n], crossings_.farther[n]});
  std::erase_if(edges_, [&](const CrossedEdge& edge) { return !rest_.Test(edge.end) || !rest_.Test(edge.other); });
  for (const uint32_t voxel : maybe_) rest_.Clear(voxel);
  return latvox::Thin(layout_, doubtful, edges_, block_, surface_);
}

TileBricks TileScan::CutOut(const TileContext& context, const Vec3i& tile_ijk) const {
  return latvox::CutOut(layout_, surface_, tile_ijk * kTileSide, context.region, context.mesh.base_ijk);
}

}  // namespace latvox
