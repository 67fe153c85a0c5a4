#include "core/thin/thin.h"

#include <algorithm>

#include "absl/container/flat_hash_set.h"
#include "core/base/sort.h"

namespace latvox {

// An unsure voxel may have left by the time of a later pass; in earlier ones it is still there.
bool Thin(const BitsLayout& layout, std::span<const uint32_t> doubtful, const std::vector<CrossedEdge>& edges,
          const IndexBox& known, const IndexBox& wanted, TileBits& set, const std::atomic<bool>& cancelled) {
  const auto is_doubtful = [&](uint32_t voxel) { return std::binary_search(doubtful.begin(), doubtful.end(), voxel); };
  absl::flat_hash_set<uint32_t> linked, unsure;
  for (const uint32_t voxel : doubtful) {
    if (cancelled) return true;
    if (!known.Contains(layout.VoxelAt(voxel))) unsure.insert(voxel);
  }
  std::vector<CrossedEdge> links;  // of doubtful voxels, as `end`
  for (const CrossedEdge& edge : edges) {
    if (cancelled) return true;
    for (const CrossedEdge& link : {edge, CrossedEdge{edge.other, edge.end}}) {
      if (!is_doubtful(link.end)) continue;
      links.push_back(link);
      linked.insert(link.end);
      if (!is_doubtful(link.other)) unsure.insert(link.other);
    }
  }
  std::vector<uint32_t> removed;
  const auto remove = [&](uint32_t voxel) {
    set.Clear(voxel);
    removed.push_back(voxel);
  };
  for (const uint32_t voxel : doubtful) {
    if (cancelled) return true;
    if (!linked.contains(voxel) && !unsure.contains(voxel)) remove(voxel);
  }
  const auto pass_order = [&](const CrossedEdge& link) {
    return uint64_t{layout.ParityClass(link.end)} << 32 | link.end;
  };
  Sort(links, cancelled, [&](const CrossedEdge& a, const CrossedEdge& b) { return pass_order(a) < pass_order(b); });

  bool decided = true;
  for (auto link = links.begin(); link != links.end();) {
    if (cancelled) return true;
    const uint32_t voxel = link->end;
    bool keep = false, may_keep = unsure.contains(voxel);
    for (; link != links.end() && link->end == voxel; ++link) {
      keep |= !set.Test(link->other);
      may_keep |= unsure.contains(link->other) && layout.ParityClass(link->other) < layout.ParityClass(voxel);
    }
    if (keep) continue;
    if (may_keep) {
      unsure.insert(voxel);
      decided &= !wanted.Contains(layout.VoxelAt(voxel));
    } else {
      remove(voxel);
    }
  }
  if (!decided) {
    for (const uint32_t voxel : removed) set.Set(voxel);
  }
  return decided;
}

}  // namespace latvox
