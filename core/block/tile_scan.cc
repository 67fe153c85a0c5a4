#include "core/block/tile_scan.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <iterator>
#include <utility>

#include "core/tile/cut_out.h"

namespace latvox {
namespace {

IndexBox Shrunk(const IndexBox& box, const Vec3i& by) { return {box.min + by, box.max - by}; }

IndexBox Union(IndexBox a, const IndexBox& b) {
  for (size_t m = 0; m < 3; ++m) {
    a.min[m] = std::min(a.min[m], b.min[m]);
    a.max[m] = std::max(a.max[m], b.max[m]);
  }
  return a;
}

// Appends to `pairs` the voxels at `positions` of one of the candidates' lists, with the triangles that put them there.
//   end   the member of Candidates::Run for that list
void AppendPairs(const Candidates& candidates, const NumberList& voxels, const NumberList& positions,
                 uint32_t Candidates::Run::*end, std::vector<VoxelTriangle>& pairs) {
  auto run = candidates.runs.begin();
  for (const uint32_t n : positions.view()) {
    while ((*run).*end <= n) ++run;
    pairs.push_back({voxels[n] & kNumberMask, candidates.TriangleAt(*run, voxels[n] >> kNumberBits)});
  }
}

}  // namespace

void TileScan::Scan(const TileContext& context, const TileNode& node, int32_t halo,
                    std::span<const uint32_t> triangles) {
  const Vec3i low = node.tile_ijk * kTileSide;
  const int32_t side = kTileSide << node.level;
  block_ = {low, low + Vec3i{side, side, side}};
  box_ = {block_.min - context.reach * halo, block_.max + context.reach * halo};
  layout_ = BitsLayout(low, context.reach * (halo + 1), side);
  for (size_t n = 0; n < context.frames.size(); ++n) steps_[n] = layout_.StepOf(context.frames[n].frame.q);
  surface_.ClearRange(std::exchange(used_, {}));
  used_box_ = {layout_.origin + layout_.side, layout_.origin};  // empty
  surface_.Resize(layout_.Words());
  candidates_.Clear();
  triangles_ = triangles;
  if (context.supercover != nullptr) return CoverAll(context);
  ForEachTinyBatch(context, [this](const Crossings& some) {
    Use(some.nearer.view());
    surface_.SetAll(some.nearer.view());
  });
  if (!context.is_tiny.empty()) {
    others_.clear();
    std::copy_if(triangles.begin(), triangles.end(), std::back_inserter(others_),
                 [&](uint32_t t) { return context.is_tiny[t] == 0; });
    triangles_ = others_;
  }
  if (context.stop.Stopped()) return;
  rim_only_.clear();
  size_t end = 0;
  do {
    in_parts_ = end > 0;
    end = Gather(context, end);
    Use(candidates_.nearer.view());
    surface_.SetAll(candidates_.nearer.view());
    AddRim(context);
  } while (end < triangles_.size() && !context.stop.Stopped());
}

// Calls f(crossings) with all edges of tiny triangles from voxels of the box, batch by batch.
template <class F>
void TileScan::ForEachTinyBatch(const TileContext& context, F&& f) const {
  if (context.edges.empty()) return;
  std::array<int32_t, kPackedDirections> steps{};
  for (size_t n = 0; n < kMaxPairs; ++n) {
    steps[2 * n] = -steps_[n];
    steps[2 * n + 1] = steps_[n];
  }
  context.edges.ForEachBatch(block_, box_, layout_, steps, f);
}

// Where few voxels lie in a large block, to clear and to cut out all of it would take most of the time.
void TileScan::Use(std::span<const uint32_t> voxels) {
  constexpr size_t kFew = 128;
  if (voxels.size() > kFew) return UsePlanes(RangeOf(voxels));
  for (const uint32_t voxel : voxels) {
    const uint32_t number = voxel & kNumberMask;
    used_.Add({number, number});
    const Vec3i ijk = layout_.VoxelAt(number);
    used_box_ = Union(used_box_, {ijk, ijk + Vec3i{1, 1, 1}});
  }
}

void TileScan::UsePlanes(const NumberRange& voxels) {
  if (voxels.empty()) return;
  used_.Add(voxels);
  IndexBox planes{layout_.origin, layout_.origin + layout_.side};
  planes.min[0] = layout_.VoxelAt(voxels.first)[0];
  planes.max[0] = layout_.VoxelAt(voxels.last)[0] + 1;
  used_box_ = Union(used_box_, planes);
}

void TileScan::CoverAll(const TileContext& context) {
  NumberRange used;
  for (const uint32_t t : triangles_) {
    if (context.stop.Stopped()) break;
    const auto& [a, b, c] = context.mesh.triangles[t];
    const auto& v = context.mesh.vertices_lat;
    context.supercover->ForEachRun({v[a], v[b], v[c]}, box_, [&](const Vec3i& first, int32_t count) {
      const uint32_t number = layout_.NumberOf(first), size = static_cast<uint32_t>(count);
      used.Add({number, number + size - 1});
      surface_.SetRun(number, size);
    });
  }
  UsePlanes(used);
}

// Finds the candidates of the triangles from `begin` on, of all or of enough of them; returns where those end. Many
// large triangles in one block, which would fill the memory, are thereby done part by part, and found again each time
// that thinning asks for them.
size_t TileScan::Gather(const TileContext& context, size_t begin) {
  constexpr size_t kEnough = size_t{1} << 20;
  candidates_.Clear();
  return begin + FindCandidates(context.mesh, triangles_.subspan(begin), context.frames, box_, layout_, context.stop,
                                kEnough, candidates_);
}

// Calls f() with the candidates of each part of the triangles at hand.
template <class F>
void TileScan::ForEachPart(const TileContext& context, F&& f) {
  if (!in_parts_) return f();
  for (size_t end = 0; end < triangles_.size() && !context.stop.Stopped();) {
    end = Gather(context, end);
    f();
  }
}

// Calls f(voxel, star) for all pairs_ whose voxel is, or is not, in `bits` when their turn comes.
template <class F>
void TileScan::ForEachStar(const TileContext& context, const TileBits& bits, bool in_set, F&& f) {
  constexpr size_t kBatch = 64;  // what f does to `bits` spares the batches that follow
  StarEdges stars[kBatch];
  VoxelTriangle batch[kBatch];
  for (size_t n = 0; n < pairs_.size() && !context.stop.Stopped();) {
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
  if (context.stop.Stopped()) return;
  surface_.Find(candidates_.rim.view(), false, positions_);
  AppendPairs(candidates_, candidates_.rim, positions_, &Candidates::Run::rim_end, pairs_);
  added_.clear();
  ForEachStar(context, surface_, false, [&](uint32_t voxel, const StarEdges& star) {
    if (star.nearer == 0 || surface_.Test(voxel)) return;
    surface_.Set(voxel);
    added_.push_back(voxel);
    rim_only_.push_back({voxel, star});
  });
  Use(added_);
}

// Calls f(farther end, direction, forward) for the edges of a star, until that returns false; returns whether it never
// did.
template <class F>
bool TileScan::ForEachEnd(uint32_t voxel, const StarEdges& star, F&& f) const {
  for (uint32_t bits = star.nearer; bits != 0; bits &= bits - 1) {
    const auto n = static_cast<size_t>(std::countr_zero(bits));
    const bool forward = (star.forward >> n & 1) != 0;
    if (!f(voxel + static_cast<uint32_t>(forward ? steps_[n] : -steps_[n]), n, forward)) return false;
  }
  return true;
}

// Adds to inner_ those of the edges whose nearer ends are in `bits`, or are not.
void TileScan::AddInner(const Crossings& some, const TileBits& bits, bool in_set) {
  bits.Find(some.nearer.view(), in_set, positions_);
  inner_.nearer.Reserve(positions_.size());
  inner_.farther.Reserve(positions_.size());
  for (const uint32_t n : positions_.view()) {
    inner_.nearer.Add(some.nearer[n]);
    inner_.farther.Add(some.farther[n]);
  }
}

// What may be redundant becomes rest_. An edge whose farther end lies outside of the surface shows its nearer end
// essential; the edges at hand, along principal directions and of tiny triangles, do so for nearly all voxels. Those
// with neighbours outside of the box, of which nothing is known, are left out.
void TileScan::FindRest(const TileContext& context) {
  rest_.Resize(layout_.Words());  // empty
  maybe_.clear();
  // Of tiny triangles, all edges are at hand: first of all, these show most voxels essential; nearly all others of such
  // a voxel's edges are in the same batch, or in later ones.
  const bool any_tiny = !context.edges.empty();
  if (any_tiny) essential_.Resize(layout_.Words());  // empty
  inner_.Clear();
  ForEachTinyBatch(context, [this](const Crossings& some) {
    inside_.Clear();
    outward_.Clear();
    surface_.Separate(some.farther.view(), some.nearer.view(), inside_.farther, inside_.nearer, outward_);
    essential_.SetAll(outward_.view());
    AddInner(inside_, essential_, false);
  });
  if (any_tiny) {
    essential_.Find(inner_.nearer.view(), false, positions_);
    inner_.nearer.Keep(positions_.view());
    inner_.farther.Keep(positions_.view());
  }
  if (context.stop.Stopped()) return;
  const IndexBox complete = Shrunk(box_, context.reach);
  const auto add = [&](uint32_t voxel) {
    if ((any_tiny && essential_.Test(voxel)) || rest_.Test(voxel) || !complete.Contains(layout_.VoxelAt(voxel))) return;
    rest_.Set(voxel);
    maybe_.push_back(voxel);
  };
  for (const uint32_t voxel : inner_.nearer.view()) add(voxel);
  ForEachPart(context, [&] {
    surface_.Find(candidates_.farther.view(), true, positions_);
    constexpr size_t kAhead = 16;  // about what memory brings at a time
    const auto nearer = [&](size_t n) { return candidates_.nearer[positions_[n]] & kNumberMask; };
    for (size_t n = 0; n < positions_.size(); ++n) {
      rest_.Prefetch(nearer(std::min(n + kAhead, positions_.size() - 1)));
      add(nearer(n));
    }
  });
  const auto in_surface = [&](uint32_t end, size_t, bool) { return surface_.Test(end); };
  for (const auto& [voxel, star] : rim_only_) {
    if (ForEachEnd(voxel, star, in_surface)) add(voxel);
  }
  if (any_tiny) essential_.ClearRange(used_);
}

// Whether a voxel is known not to belong to the surface.
bool TileScan::IsOutside(uint32_t voxel) const {
  return !surface_.Test(voxel) && box_.Contains(layout_.VoxelAt(voxel));
}

// Asks all triangles at members of rest_: voxels that prove essential leave it, edges within it are recorded.
void TileScan::AskRest(const TileContext& context) {
  edges_.Reset(layout_);
  for (const ScanFrame& scan : context.frames) edges_.AddDirection(layout_, scan.frame.q);
  ForEachPart(context, [&] { AskRestOfPart(context); });
  for (size_t n = 0; n < inner_.nearer.size(); ++n) {
    const uint32_t end = inner_.nearer[n], other = inner_.farther[n];
    if (rest_.Test(end) && rest_.Test(other)) edges_.Add(end, other);
  }
}

// Voxels that one list's triangles prove essential spare those of the next.
void TileScan::AskRestOfPart(const TileContext& context) {
  if (FindPairsByBoxes()) return AskPairs(context);
  FindInRest(candidates_.nearer);
  for (const uint32_t n : positions_.view()) {
    if (IsOutside(candidates_.farther[n] & kNumberMask)) rest_.Clear(candidates_.nearer[n] & kNumberMask);
  }
  AskAtPositions(context, candidates_.nearer, &Candidates::Run::crossed_end);
  FindInRest(candidates_.rim);
  AskAtPositions(context, candidates_.rim, &Candidates::Run::rim_end);
}

// Finds pairs_ of members of rest_ by the triangles' boxes, if that seems to take less than to find the members among
// all candidates; returns whether it did, else they mean nothing. It finds some pairs more, whose stars have no edges.
bool TileScan::FindPairsByBoxes() {
  const size_t triangles = candidates_.triangles.size();
  if (candidates_.boxes.size() != triangles) return false;
  UpdateMaybe();
  // What takes as long as so many candidates: to compare a voxel with a triangle's box, and the stars more.
  constexpr double kPerBox = 0.3, kPerVoxel = 100;
  if (static_cast<double>(maybe_.size()) * (static_cast<double>(triangles) * kPerBox + kPerVoxel) >
      static_cast<double>(candidates_.size())) {
    return false;
  }
  // Boxes say little of large triangles askew.
  constexpr size_t kUsual = 3, kPerPair = 100;
  const size_t most = kUsual * maybe_.size() + candidates_.size() / kPerPair;
  return candidates_.boxes.FindPairs(layout_, box_.min, candidates_.triangles, maybe_, most, pairs_);
}

// Takes what has left rest_ out of maybe_.
void TileScan::UpdateMaybe() {
  std::erase_if(maybe_, [&](uint32_t voxel) { return !rest_.Test(voxel); });
}

// Finds the positions of those voxels of a list that are in rest_.
void TileScan::FindInRest(const NumberList& voxels) {
  UpdateMaybe();
  rest_.FindFew(voxels.view(), maybe_, positions_);
}

// Asks the triangles that put the voxels at these positions into their list.
void TileScan::AskAtPositions(const TileContext& context, const NumberList& voxels,
                              uint32_t Candidates::Run::*run_end) {
  pairs_.clear();
  AppendPairs(candidates_, voxels, positions_, run_end, pairs_);
  AskPairs(context);
}

// Asks the triangles of pairs_ whose voxels are in rest_ when their turn comes.
void TileScan::AskPairs(const TileContext& context) {
  ForEachStar(context, rest_, true, [&](uint32_t z, const StarEdges& star) {
    const bool may_leave = ForEachEnd(z, star, [&](uint32_t end, size_t direction, bool forward) {
      if (!surface_.Test(end)) return !box_.Contains(layout_.VoxelAt(end));  // beyond, nothing is known
      if (rest_.Test(end)) edges_.Add(z, direction, forward);
      return true;
    });
    if (!may_leave) rest_.Clear(z);
  });
}

// Adds to rest_, and to maybe_, those neighbours of members that have neighbours outside of the box.
void TileScan::AddBorder(const TileContext& context, std::span<const uint32_t> members) {
  const IndexBox complete = Shrunk(box_, context.reach);
  for (const uint32_t voxel : members) {
    if (context.stop.Stopped()) return;
    for (const ScanFrame& scan : context.frames) {
      const auto step = static_cast<uint32_t>(layout_.StepOf(scan.frame.q));
      for (const uint32_t neighbour : {voxel + step, voxel - step}) {
        if (!surface_.Test(neighbour) || rest_.Test(neighbour)) continue;
        if (complete.Contains(layout_.VoxelAt(neighbour))) continue;
        rest_.Set(neighbour);
        maybe_.push_back(neighbour);
      }
    }
  }
  inner_.Clear();
  ForEachTinyBatch(context, [this](const Crossings& some) { AddInner(some, rest_, true); });
  // That an edge leads out of the box shows nothing.
  for (size_t n = 0; n < inner_.nearer.size(); ++n) {
    if (IsOutside(inner_.farther[n])) rest_.Clear(inner_.nearer[n]);
  }
}

// Of what FindRest leaves, the triangles at hand decide. What lies beyond the border matters seldom.
bool TileScan::Thin(const TileContext& context) {
  // Where many triangles meet in few voxels, each of these takes a while.
  if (!context.stop.Stopped()) FindRest(context);
  if (!context.stop.Stopped()) AskRest(context);
  if (context.stop.Stopped()) return true;
  std::vector<uint32_t> doubtful;
  std::copy_if(maybe_.begin(), maybe_.end(), std::back_inserter(doubtful), [&](uint32_t n) { return rest_.Test(n); });
  const IndexBox known = Shrunk(box_, context.reach * 2);
  bool decided = latvox::Thin(layout_, doubtful, rest_, edges_, known, block_, surface_, context.stop);
  if (!decided) {
    AddBorder(context, doubtful);
    AskRest(context);
    decided = latvox::Thin(layout_, doubtful, rest_, edges_, box_, block_, surface_, context.stop);
  }
  for (const uint32_t voxel : maybe_) rest_.Clear(voxel);
  return decided;
}

// Rows of a tile begin at whole bytes.
void TileScan::AddRows(const Vec3i& tile_ijk, std::span<const uint64_t> rows) {
  static_assert(std::endian::native == std::endian::little, "words of both sizes are read as bytes");
  auto* const bytes = reinterpret_cast<char*>(surface_.words().data());
  const Vec3i low = tile_ijk * kTileSide;
  NumberRange used;
  for (int32_t row = 0; row < kTileSide * kTileSide; ++row) {
    const uint64_t added = rows[static_cast<size_t>(row)];
    if (added == 0) continue;
    const uint32_t number = layout_.NumberOf(low + Vec3i{row / kTileSide, row % kTileSide, 0});
    used.Add({number, number + kTileSide - 1});
    char* const at = bytes + number / 8;
    uint64_t word;
    std::memcpy(&word, at, sizeof(word));
    word |= added;
    std::memcpy(at, &word, sizeof(word));
  }
  UsePlanes(used);
}

TileBricks TileScan::CutOut(const TileContext& context, const Vec3i& tile_ijk) const {
  IndexBox used;  // in whole bricks, which need not be clipped
  for (size_t m = 0; m < 3; ++m) {
    used.min[m] = used_box_.min[m] & -kBrickSide;
    used.max[m] = (used_box_.max[m] + kBrickSide - 1) & -kBrickSide;
  }
  return latvox::CutOut(layout_, surface_, tile_ijk * kTileSide, Intersection(context.region, used),
                        context.mesh.base_ijk);
}

size_t TileScan::Bytes() const {
  size_t bytes = surface_.Bytes() + essential_.Bytes() + rest_.Bytes() + BytesOf(others_) + candidates_.Bytes();
  bytes += positions_.Bytes() + inside_.Bytes() + outward_.Bytes() + inner_.Bytes() + BytesOf(added_);
  return bytes + BytesOf(rim_only_) + BytesOf(maybe_) + BytesOf(pairs_) + edges_.Bytes();
}

}  // namespace latvox
