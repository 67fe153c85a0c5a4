#include "core/block/thinner.h"

#include <algorithm>
#include <bit>
#include <iterator>
#include <utility>

#include "core/base/bytes_of.h"
#include "core/thin/thin.h"

namespace latvox {
namespace {

// Returns whether a voxel is known not to belong to the surface.
bool IsOutside(const BlockVoxels& voxels, uint32_t voxel) {
  return !voxels.bits().Test(voxel) && voxels.where().box.Contains(voxels.where().layout.VoxelAt(voxel));
}

// Returns whether all links of the voxel's star end in the set.
bool EndsIn(const TileBits& set, const BlockBox& where, const RimVoxel& rim) {
  for (uint32_t bits = rim.star.nearer; bits != 0; bits &= bits - 1) {
    if (!set.Test(where.EndOf(rim.voxel, rim.star, static_cast<size_t>(std::countr_zero(bits))))) return false;
  }
  return true;
}

}  // namespace

bool Thinner::Thin(const TileContext& context, const ScannedSurface& scanned) {
  std::swap(memory_, scanned.memory);
  const bool decided = Decide(context, scanned);
  std::swap(memory_, scanned.memory);
  return decided;
}

// The triangles at hand decide on the voxels that FindUndecided leaves. Triangles beyond the border seldom matter.
// Where many voxels are doubtful, voxels at the border matter.
bool Thinner::Decide(const TileContext& context, const ScannedSurface& scanned) {
  // Where many triangles meet in few voxels, each step takes a while.
  if (!context.stop.Stopped()) FindUndecided(context, scanned);
  const BlockBox& where = scanned.voxels.where();
  links_.Reset(where.layout);
  for (const ScanFrame& scan : context.frames) links_.AddDirection(where.layout, scan.frame.q);
  // Pairs that wait take memory. Where few voxels are undecided, their links rule most of them out at once. Links of
  // tiny triangles are known, and those of the border cost more than they spare.
  constexpr size_t kMany = 16;
  in_passes_ =
      context.links.empty() && scanned.candidates.IsWhole() && list_.size() * kMany > scanned.candidates.size();
  const IndexBox known = where.Shrunk(context.reach * 2);
  bool decided = false;
  if (!in_passes_) {
    if (!context.stop.Stopped()) Ask(context, scanned);
    UpdateList();
    decided = Pass(context, scanned, known);
  }
  if (!decided && !context.stop.Stopped()) {
    const std::vector<uint32_t> doubtful = list_;
    if (!in_passes_) {
      // The links of voxels inside `known` are known, and most voxels are there: they are not asked again.
      for (const uint32_t voxel : doubtful) {
        if (known.Contains(where.layout.VoxelAt(voxel))) undecided_.Clear(voxel);
      }
    }
    AddBorder(context, scanned.voxels, doubtful);
    Ask(context, scanned);
    if (!in_passes_) {
      UpdateList();
      for (const uint32_t voxel : doubtful) {
        if (undecided_.Test(voxel)) continue;
        undecided_.Set(voxel);
        list_.push_back(voxel);
      }
    }
    decided = Pass(context, scanned, where.Shrunk(context.reach));
  }
  for (const uint32_t voxel : list_) undecided_.Clear(voxel);
  for (std::vector<VoxelTriangle>& pairs : waiting_) pairs.clear();
  return decided || context.stop.Stopped();
}

// Decides on the voxels of list_, as far as the known links allow.
bool Thinner::Pass(const TileContext& context, const ScannedSurface& scanned, const IndexBox& known) {
  const BlockBox& where = scanned.voxels.where();
  const auto ask = [&](uint32_t parity) { AskPairs(context, scanned.voxels, waiting_[parity]); };
  return latvox::Thin(where.layout, list_, undecided_, links_, ask, known, where.wanted, scanned.voxels.bits(),
                      context.stop);
}

// A link with its farther end outside of the surface shows its nearer end essential. The links at hand, along principal
// directions and of tiny triangles, do so for nearly all voxels. Voxels with neighbors outside of the box are left out,
// because nothing is known about those.
void Thinner::FindUndecided(const TileContext& context, const ScannedSurface& scanned) {
  const BlockBox& where = scanned.voxels.where();
  const TileBits& surface = scanned.voxels.bits();
  undecided_.Resize(where.layout.Words());  // empty
  list_.clear();
  const bool any_tiny = !context.links.empty();
  inner_.Clear();
  if (any_tiny) FindInnerAndEssential(context, scanned);
  if (context.stop.Stopped()) return;
  const IndexBox complete = where.Shrunk(context.reach);
  const auto add = [&](uint32_t voxel) {
    if ((any_tiny && essential_.Test(voxel)) || undecided_.Test(voxel)) return;
    const Vec3i ijk = where.layout.VoxelAt(voxel);
    const bool matters =
        where.wanted.Contains(ijk) || (complete.Contains(ijk) && MayMatter(ijk, where.wanted, context.reach));
    if (!matters) return;
    undecided_.Set(voxel);
    list_.push_back(voxel);
  };
  for (const uint32_t voxel : inner_.nearer.view()) add(voxel);
  scanned.candidates.ForEach(context, where, [&](const Candidates& candidates) {
    surface.Find(candidates.farther.view(), true, memory_.positions);
    constexpr size_t kAhead = 16;  // about the number of accesses that memory serves at a time
    const auto nearer = [&](size_t n) { return candidates.nearer[memory_.positions[n]] & kNumberMask; };
    for (size_t n = 0; n < memory_.positions.size(); ++n) {
      undecided_.Prefetch(nearer(std::min(n + kAhead, memory_.positions.size() - 1)));
      add(nearer(n));
    }
  });
  for (const RimVoxel& rim : scanned.rim_only) {
    if (EndsIn(surface, where, rim)) add(rim.voxel);
  }
  if (any_tiny) essential_.ClearRange(scanned.voxels.dirty());
}

// All links of tiny triangles are at hand. They show most voxels essential at once. Nearly all other links of such a
// voxel are in the same batch, or in later ones.
void Thinner::FindInnerAndEssential(const TileContext& context, const ScannedSurface& scanned) {
  const BlockBox& where = scanned.voxels.where();
  const TileBits& surface = scanned.voxels.bits();
  essential_.Resize(where.layout.Words());  // empty
  where.ForEachTinyBatch(context, [&](const Crossings& some) {
    inside_.Clear();
    outward_.Clear();
    surface.Separate(some.farther.view(), some.nearer.view(), inside_.farther, inside_.nearer, outward_);
    essential_.SetAll(outward_.view());
    AddInner(inside_, essential_, false);
  });
  essential_.Find(inner_.nearer.view(), false, memory_.positions);
  inner_.nearer.Keep(memory_.positions.view());
  inner_.farther.Keep(memory_.positions.view());
}

// Adds to inner_ the links with nearer ends in `bits`, or not in `bits`.
void Thinner::AddInner(const Crossings& some, const TileBits& bits, bool in_set) {
  bits.Find(some.nearer.view(), in_set, memory_.positions);
  inner_.nearer.Reserve(memory_.positions.size());
  inner_.farther.Reserve(memory_.positions.size());
  for (const uint32_t n : memory_.positions.view()) {
    inner_.nearer.Add(some.nearer[n]);
    inner_.farther.Add(some.farther[n]);
  }
}

// Asks all triangles at undecided voxels. Voxels that prove essential leave; links between the others are recorded.
void Thinner::Ask(const TileContext& context, const ScannedSurface& scanned) {
  const BlockBox& where = scanned.voxels.where();
  scanned.candidates.ForEach(context, where,
                             [&](const Candidates& candidates) { AskCandidates(context, scanned.voxels, candidates); });
  for (size_t n = 0; n < inner_.nearer.size(); ++n) {
    const uint32_t end = inner_.nearer[n], other = inner_.farther[n];
    if (undecided_.Test(end) && undecided_.Test(other)) links_.AddBetween(end, other);
  }
}

// Voxels that one list's triangles prove essential spare those of the next list.
void Thinner::AskCandidates(const TileContext& context, BlockVoxels& voxels, const Candidates& candidates) {
  if (FindPairsByBoxes(voxels.where(), candidates)) return AskInTime(context, voxels);
  FindInUndecided(candidates.nearer);
  ForEachPiece(memory_.positions, context.stop, [&](std::span<const uint32_t> piece) {
    for (const uint32_t n : piece) {
      if (IsOutside(voxels, candidates.farther[n] & kNumberMask)) undecided_.Clear(candidates.nearer[n] & kNumberMask);
    }
  });
  if (context.stop.Stopped()) return;
  FindPairs(candidates, candidates.nearer, memory_.positions, &Candidates::Run::crossed_end, context.stop,
            memory_.pairs);
  AskInTime(context, voxels);
  if (context.stop.Stopped()) return;
  FindInUndecided(candidates.rim);
  FindPairs(candidates, candidates.rim, memory_.positions, &Candidates::Run::rim_end, context.stop, memory_.pairs);
  AskInTime(context, voxels);
}

// Finds pairs of undecided voxels by the triangles' boxes, if that seems cheaper than a search for the voxels among all
// candidates. Returns whether it did; otherwise the pairs are meaningless. It finds some extra pairs, with stars
// without links.
bool Thinner::FindPairsByBoxes(const BlockBox& where, const Candidates& candidates) {
  const size_t triangles = candidates.triangles.size();
  if (candidates.boxes.size() != triangles) return false;
  UpdateList();
  // The costs in candidates: a voxel compared with a triangle's box, and the further stars.
  constexpr double kPerBox = 0.3, kPerVoxel = 100;
  if (static_cast<double>(list_.size()) * (static_cast<double>(triangles) * kPerBox + kPerVoxel) >
      static_cast<double>(candidates.size())) {
    return false;
  }
  // Boxes say little about large oblique triangles.
  constexpr size_t kUsual = 3, kPerPair = 100;
  const size_t most = kUsual * list_.size() + candidates.size() / kPerPair;
  return candidates.boxes.FindPairs(where.layout, where.box.min, candidates.triangles, list_, most, memory_.pairs);
}

// Removes voxels that have left undecided_ from list_.
void Thinner::UpdateList() {
  std::erase_if(list_, [&](uint32_t voxel) { return !undecided_.Test(voxel); });
}

// Finds the positions of the undecided voxels of a list.
void Thinner::FindInUndecided(const NumberList& voxels) {
  UpdateList();
  undecided_.FindFew(voxels.view(), list_, memory_.positions);
}

// Asks the pairs in memory_ now, or has them wait for the pass of their voxel.
void Thinner::AskInTime(const TileContext& context, BlockVoxels& voxels) {
  if (!in_passes_) return AskPairs(context, voxels, memory_.pairs);
  const BitsLayout& layout = voxels.where().layout;
  for (const VoxelTriangle& pair : memory_.pairs) waiting_[layout.ParityClass(pair.voxel)].push_back(pair);
}

// Asks the triangles of pairs whose voxels are undecided when their turn comes. Once all links of a voxel are known,
// they all end in the surface, and no further triangle matters: that spares most questions where triangles fill a
// volume.
void Thinner::AskPairs(const TileContext& context, BlockVoxels& voxels, std::span<const VoxelTriangle> pairs) {
  const BlockBox& where = voxels.where();
  const TileBits& surface = voxels.bits();
  const auto is_open = [this](uint32_t voxel) { return undecided_.Test(voxel) && !links_.IsFull(voxel); };
  ForEachStar(context, where.layout, pairs, is_open, [&](uint32_t z, const StarLinks& star) {
    uint32_t& links = links_.At(z);
    for (uint32_t bits = CrossedLinks::BitsOf(star.nearer, star.forward) & ~links; bits != 0; bits &= bits - 1) {
      const uint32_t end = links_.EndOf(z, static_cast<size_t>(std::countr_zero(bits)));
      if (!surface.Test(end)) {
        if (!where.box.Contains(where.layout.VoxelAt(end))) continue;  // beyond, nothing is known
        undecided_.Clear(z);
        break;
      }
      links |= bits & -bits;
    }
  });
}

// Adds those neighbors of members that have neighbors outside of the box.
void Thinner::AddBorder(const TileContext& context, BlockVoxels& voxels, std::span<const uint32_t> members) {
  const BlockBox& where = voxels.where();
  const IndexBox complete = where.Shrunk(context.reach);
  const IndexBox far_inside = where.Shrunk(context.reach * 2);  // all neighbors are in `complete`
  for (const uint32_t voxel : members) {
    if (context.stop.Stopped()) return;
    if (far_inside.Contains(where.layout.VoxelAt(voxel))) continue;
    for (const ScanFrame& scan : context.frames) {
      const auto step = static_cast<uint32_t>(where.layout.StepOf(scan.frame.q));
      for (const uint32_t neighbor : {voxel + step, voxel - step}) {
        if (!voxels.bits().Test(neighbor) || undecided_.Test(neighbor)) continue;
        const Vec3i ijk = where.layout.VoxelAt(neighbor);
        if (complete.Contains(ijk) || !MayMatter(ijk, where.wanted, context.reach)) continue;
        undecided_.Set(neighbor);
        list_.push_back(neighbor);
      }
    }
  }
  inner_.Clear();
  where.ForEachTinyBatch(context, [this](const Crossings& some) { AddInner(some, undecided_, true); });
  // A link that leads out of the box shows nothing.
  for (size_t n = 0; n < inner_.nearer.size(); ++n) {
    if (IsOutside(voxels, inner_.farther[n])) undecided_.Clear(inner_.nearer[n]);
  }
}

size_t Thinner::Bytes() const {
  size_t bytes = undecided_.Bytes() + BytesOf(list_) + essential_.Bytes() + inside_.Bytes() + outward_.Bytes();
  bytes += inner_.Bytes();
  for (const std::vector<VoxelTriangle>& pairs : waiting_) bytes += BytesOf(pairs);
  return bytes + links_.Bytes();
}

}  // namespace latvox
