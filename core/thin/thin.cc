#include "core/thin/thin.h"

#include <algorithm>

#include "absl/container/flat_hash_set.h"

namespace latvox {

// An unsure voxel may have left by the time of a later pass; in earlier ones it is still there.
bool Thin(const BitsLayout& layout, std::span<const uint32_t> doubtful, const std::vector<CrossedEdge>& edges,
          const IndexBox& wanted, TileBits& set) {
  const auto is_doubtful = [&](uint32_t voxel) { return std::binary_search(doubtful.begin(), doubtful.end(), voxel); };
  absl::flat_hash_set<uint32_t> linked, unsure;
  std::vector<CrossedEdge> links;  // of doubtful voxels, as `end`
  for (const CrossedEdge& edge : edges) {
    for (const CrossedEdge& link : {edge, CrossedEdge{edge.other, edge.end}}) {
      if (!is_doubtful(link.end)) continue;
      links.push_back(link);
      linked.insert(link.end);
      if (!is_doubtful(link.other)) unsure.insert(link.other);
    }
  }
  for (const uint32_t voxel : doubtful) {
    if (!linked.contains(voxel)) set.Clear(voxel);
  }
  const auto pass_order = [&](const CrossedEdge& link) {
    return uint64_t{layout.ParityClass(link.end)} << 32 | link.end;
  };
  std::sort(links.begin(), links.end(),
            [&](const CrossedEdge& a, const CrossedEdge& b) { return pass_order(a) < pass_order(b); });

  bool decided = true;
  for (auto link = links.begin(); link != links.end();) {
    const uint32_t voxel = link->end;
    bool keep = false, may_keep = false;
    for (; link != links.end() && link->end == voxel; ++link) {
      keep |= !set.Test(link->other);
      may_keep |= unsure.contains(link->other) && layout.ParityClass(link->other) < layout.ParityClass(voxel);
    }
    if (keep) continue;
    if (may_keep) {
      unsure.insert(voxel);
      decided &= !wanted.Contains(layout.VoxelAt(voxel));
    } else {
      set.Clear(voxel);
    }
  }
  return decided;
}

}  // namespace latvox
