#include "core/thin/thin.h"

#include <algorithm>
#include <array>
#include <vector>

namespace latvox {

// Only voxels of lower classes may have left before a voxel's pass, so only the links to these are looked at. An unsure
// voxel may have left by the time of a later pass. A voxel that may be doubtful and is not listed is unsure.
bool Thin(const BitsLayout& layout, std::span<const uint32_t> doubtful, const TileBits& doubted, CrossedLinks& links,
          const IndexBox& known, const IndexBox& wanted, TileBits& set, StopSignal stop) {
  constexpr uint32_t kListed = CrossedLinks::kListed, kUnsure = CrossedLinks::kUnsure;
  std::array<std::vector<uint32_t>, kParityClasses> passes;
  constexpr size_t kAhead = 16;  // about the number of accesses that memory serves at a time
  for (size_t n = 0; n < doubtful.size(); ++n) {
    if (stop.Stopped()) return true;
    const uint32_t voxel = doubtful[n];
    links.Prefetch(doubtful[std::min(n + kAhead, doubtful.size() - 1)]);
    uint32_t& word = links.At(voxel);
    word = (word & CrossedLinks::kLinks) | kListed | (known.Contains(layout.VoxelAt(voxel)) ? 0 : kUnsure);
    passes[layout.ParityClass(voxel)].push_back(voxel);
  }
  std::vector<uint32_t> removed;
  for (uint32_t parity = 0; parity < kParityClasses; ++parity) {
    const uint32_t to_lower = links.ToLowerClasses(parity);
    for (const uint32_t voxel : passes[parity]) {
      if (stop.Stopped()) return true;
      const uint32_t word = links.Get(voxel);
      bool may_keep = (word & kUnsure) != 0;
      const bool keep = links.Any(voxel, word & to_lower, [&](uint32_t other) {
        if (!set.Test(other)) return true;
        may_keep |= doubted.Test(other) && (links.Get(other) & (kListed | kUnsure)) != kListed;
        return false;
      });
      if (keep) continue;
      if (!may_keep) {
        set.Clear(voxel);
        removed.push_back(voxel);
      } else if (wanted.Contains(layout.VoxelAt(voxel))) {
        for (const uint32_t gone : removed) set.Set(gone);
        return false;
      } else {
        links.At(voxel) |= kUnsure;
      }
    }
  }
  return true;
}

}  // namespace latvox
