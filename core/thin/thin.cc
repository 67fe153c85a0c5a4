#include "core/thin/thin.h"

#include <algorithm>

namespace latvox {
namespace {

// A voxel that may be redundant, and the other end of one of its crossed edges.
struct Incidence {
  uint32_t voxel, other;

  // By class first: the order of the passes.
  friend bool operator<(const Incidence& a, const Incidence& b) {
    const uint32_t class_a = ParityClass(a.voxel), class_b = ParityClass(b.voxel);
    return class_a != class_b ? class_a < class_b : a.voxel < b.voxel;
  }
};

IndexBox Shrunk(IndexBox box, const Vec3i& by) { return {box.min + by, box.max - by}; }

}  // namespace

// Only voxels that are redundant before the first pass can ever be removed; they are few (below 1 % on smooth
// surfaces), so the passes run over their crossed edges alone.
//
// Within `reach` of the border of `known` a voxel's crossed edges are not all there. Such a voxel is kept for certain
// if a known edge shows it essential; else, once its pass has come, it is `unsure`, and so is what depends on it.
bool Thin(TileBox& set, const std::vector<CrossedEdge>& edges, const IndexBox& known, const Vec3i& reach,
          const IndexBox& wanted) {
  TileBox essential = set.EmptyLike();
  for (const CrossedEdge& edge : edges) {
    if (!set.Test(edge.farther) && known.Contains(set.VoxelAt(edge.farther))) essential.Set(edge.nearer);
  }

  std::vector<Incidence> candidates;
  for (const CrossedEdge& edge : edges) {
    if (!essential.Test(edge.nearer)) candidates.push_back({edge.nearer, edge.farther});
    if (set.Test(edge.farther) && !essential.Test(edge.farther)) candidates.push_back({edge.farther, edge.nearer});
  }
  std::sort(candidates.begin(), candidates.end());

  const IndexBox complete = Shrunk(known, reach);
  TileBox unsure = set.EmptyLike();
  bool decided = true;
  for (auto first = candidates.begin(); first != candidates.end();) {
    const uint32_t voxel = first->voxel;
    const Vec3i ijk = set.VoxelAt(voxel);
    bool keep = false, may_keep = !complete.Contains(ijk);
    for (; first != candidates.end() && first->voxel == voxel; ++first) {
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
