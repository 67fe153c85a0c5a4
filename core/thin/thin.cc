#include "core/thin/thin.h"

#include <algorithm>

#include "core/base/sort.h"

namespace latvox {

namespace {

// A crossed edge of a doubtful voxel; doubtful ones by their places in the list of them.
struct Link {
  uint32_t end, other;
  uint32_t end_place, other_place;
};
constexpr uint32_t kNowhere = UINT32_MAX;

}  // namespace

// An unsure voxel may have left by the time of a later pass; in earlier ones it is still there. Those that are not
// known to be doubtful, but linked to one, are unsure.
bool Thin(const BitsLayout& layout, std::span<const uint32_t> doubtful, const std::vector<CrossedEdge>& edges,
          const IndexBox& known, const IndexBox& wanted, TileBits& set, const std::atomic<bool>& cancelled) {
  const auto place_of = [&](uint32_t voxel) {
    const auto at = std::lower_bound(doubtful.begin(), doubtful.end(), voxel);
    return at != doubtful.end() && *at == voxel ? static_cast<uint32_t>(at - doubtful.begin()) : kNowhere;
  };
  std::vector<bool> linked(doubtful.size()), unsure(doubtful.size());
  for (size_t n = 0; n < doubtful.size(); ++n) {
    if (cancelled) return true;
    unsure[n] = !known.Contains(layout.VoxelAt(doubtful[n]));
  }
  std::vector<Link> links;
  for (const CrossedEdge& edge : edges) {
    if (cancelled) return true;
    const Link there{edge.end, edge.other, place_of(edge.end), place_of(edge.other)};
    const Link back{there.other, there.end, there.other_place, there.end_place};
    for (const Link& link : {there, back}) {
      if (link.end_place == kNowhere) continue;
      links.push_back(link);
      linked[link.end_place] = true;
    }
  }
  std::vector<uint32_t> removed;
  const auto remove = [&](uint32_t voxel) {
    set.Clear(voxel);
    removed.push_back(voxel);
  };
  for (size_t n = 0; n < doubtful.size(); ++n) {
    if (cancelled) return true;
    if (!linked[n] && !unsure[n]) remove(doubtful[n]);
  }
  const auto pass_order = [&](const Link& link) { return uint64_t{layout.ParityClass(link.end)} << 32 | link.end; };
  Sort(links, cancelled, [&](const Link& a, const Link& b) { return pass_order(a) < pass_order(b); });

  bool decided = true;
  for (auto link = links.begin(); link != links.end();) {
    if (cancelled) return true;
    const uint32_t voxel = link->end, place = link->end_place;
    bool keep = false, may_keep = unsure[place];
    for (; link != links.end() && link->end == voxel; ++link) {
      keep |= !set.Test(link->other);
      may_keep |= (link->other_place == kNowhere || unsure[link->other_place]) &&
                  layout.ParityClass(link->other) < layout.ParityClass(voxel);
    }
    if (keep) continue;
    if (may_keep) {
      unsure[place] = true;
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
