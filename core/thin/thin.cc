#include "core/thin/thin.h"

#include <algorithm>

namespace latvox {
namespace {

// By class first: the order of the passes.
uint64_t PassOrder(const CrossedEdge& edge) {
  return (uint64_t{ParityClass(edge.end)} << 32 | edge.end) << 29 | edge.other;
}

IndexBox Shrunk(const IndexBox& box, const Vec3i& by) { return {box.min + by, box.max - by}; }

}  // namespace

TileBox PossiblyRedundant(const TileBox& set, const std::vector<CrossedEdge>& edges) {
  TileBox rest = set;
  for (const CrossedEdge& edge : edges) {
    if (!set.Test(edge.other)) rest.Clear(edge.end);
  }
  return rest;
}

// Within `reach` of the border of `known` a voxel's other ends may be unknown. Such a voxel is kept for certain if a
// known edge shows it essential; else, once its pass has come, it is `unsure`, and so is what depends on it.
bool Thin(TileBox& set, std::vector<CrossedEdge> edges, const IndexBox& known, const Vec3i& reach,
          const IndexBox& wanted) {
  std::sort(edges.begin(), edges.end(),
            [](const CrossedEdge& a, const CrossedEdge& b) { return PassOrder(a) < PassOrder(b); });
  const IndexBox complete = Shrunk(known, reach);
  TileBox unsure = set.EmptyLike();
  bool decided = true;
  for (auto first = edges.begin(); first != edges.end();) {
    const uint32_t voxel = first->end;
    const Vec3i ijk = set.VoxelAt(voxel);
    bool keep = false, may_keep = !complete.Contains(ijk);
    for (; first != edges.end() && first->end == voxel; ++first) {
      if (unsure.Test(first->other)) {
        may_keep = true;
      } else if (!set.Test(first->other) && known.Contains(set.VoxelAt(first->other))) {
        keep = true;
      }
    }
    if (keep) continue;
    if (may_keep) {
      unsure.Set(voxel);
      decided &= !wanted.Contains(ijk);
    } else {
      set.Clear(voxel);
    }
  }
  return decided;
}

}  // namespace latvox
