#include "core/thin/thin.h"

#include <algorithm>
#include <bit>

namespace latvox {
namespace {

// By class first: the order of the passes.
uint64_t PassOrder(const CrossedEdge& edge) {
  return (uint64_t{ParityClass(edge.end)} << 32 | edge.end) << 29 | edge.other;
}

}  // namespace

Doubtful FindDoubtful(const TileBox& set, const std::vector<CrossedEdge>& edges, const IndexBox& complete) {
  Doubtful doubtful{set, set.EmptyLike()};
  for (const CrossedEdge& edge : edges) {
    if (!set.Test(edge.other)) doubtful.rest.Clear(edge.end);
  }
  for (size_t n = 0; n < set.words().size(); ++n) {
    for (uint64_t bits = doubtful.rest.words()[n]; bits != 0; bits &= bits - 1) {
      const auto voxel = static_cast<uint32_t>(n * 64) + static_cast<uint32_t>(std::countr_zero(bits));
      if (complete.Contains(set.VoxelAt(voxel))) continue;
      doubtful.rest.Clear(voxel);
      doubtful.unsure.Set(voxel);
    }
  }
  return doubtful;
}

// An unsure voxel may have left by the time of a later pass; in earlier ones it is still there.
bool Thin(TileBox& set, Doubtful doubtful, std::vector<CrossedEdge> edges, const IndexBox& wanted) {
  std::sort(edges.begin(), edges.end(),
            [](const CrossedEdge& a, const CrossedEdge& b) { return PassOrder(a) < PassOrder(b); });
  bool decided = true;
  for (auto first = edges.begin(); first != edges.end();) {
    const uint32_t voxel = first->end;
    bool keep = false, may_keep = false;
    for (; first != edges.end() && first->end == voxel; ++first) {
      keep |= !set.Test(first->other);
      may_keep |= doubtful.unsure.Test(first->other) && ParityClass(first->other) < ParityClass(voxel);
    }
    if (keep) continue;
    if (may_keep) {
      doubtful.unsure.Set(voxel);
      decided &= !wanted.Contains(set.VoxelAt(voxel));
    } else {
      set.Clear(voxel);
    }
  }
  return decided;
}

}  // namespace latvox
