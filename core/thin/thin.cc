#include "core/thin/thin.h"

#include <algorithm>
#include <array>
#include <vector>

namespace latvox {

// Only voxels of lower classes may have left before a voxel's pass, so only the links to these are looked at. An unsure
// voxel may have left by the time of a later pass; it makes the other ends of its links unsure.
bool Thin(const BitsLayout& layout, std::span<const uint32_t> members, TileBits& doubted, CrossedLinks& links,
          const std::function<void(uint32_t parity)>& ask, const IndexBox& known, const IndexBox& wanted, TileBits& set,
          StopSignal stop) {
  constexpr uint32_t kUnsure = CrossedLinks::kUnsure;
  links.ClearMarks();
  std::array<std::vector<uint32_t>, kParityClasses> passes;
  for (std::vector<uint32_t>& pass : passes) pass.reserve(members.size() / 4);
  for (const uint32_t voxel : members) passes[layout.ParityClass(voxel)].push_back(voxel);
  std::vector<uint32_t> removed;
  for (uint32_t parity = 0; parity < kParityClasses; ++parity) {
    ask(parity);
    const uint32_t to_lower = links.ToLowerClasses(parity);
    for (const uint32_t voxel : passes[parity]) {
      if (stop.Stopped()) return true;
      if (!doubted.Test(voxel)) continue;
      const uint32_t word = links.Get(voxel);
      bool may_keep = (word & kUnsure) != 0;
      const bool keep = links.Any(voxel, word & to_lower, [&](uint32_t other) {
        if (!set.Test(other)) return true;
        may_keep |= doubted.Test(other) && (links.Get(other) & kUnsure) != 0;
        return false;
      });
      if (keep) {
        doubted.Clear(voxel);
        continue;
      }
      const Vec3i ijk = layout.VoxelAt(voxel);
      if (!may_keep && known.Contains(ijk)) {
        set.Clear(voxel);
        removed.push_back(voxel);
        links.ForEach(voxel, word & ~to_lower, [&](uint32_t other) { doubted.Clear(other); });
      } else if (wanted.Contains(ijk)) {
        for (const uint32_t gone : removed) set.Set(gone);
        return false;
      } else {
        links.At(voxel) |= kUnsure;
        links.ForEach(voxel, word & ~to_lower, [&](uint32_t other) { links.At(other) |= kUnsure; });
      }
    }
  }
  return true;
}

}  // namespace latvox
