#include "core/thin/thin.h"

#include <algorithm>
#include <array>
#include <vector>

namespace latvox {

// An unsure voxel may have left by the time of a later pass; in earlier passes it is still there. A voxel that may be
// doubtful and is not listed is unsure.
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
  bool decided = true;
  std::vector<uint32_t> removed;
  for (uint32_t parity = 0; parity < kParityClasses; ++parity) {
    for (const uint32_t voxel : passes[parity]) {
      if (stop.Stopped()) return true;
      const uint32_t word = links.Get(voxel);
      bool may_keep = (word & kUnsure) != 0;
      const bool keep = links.Any(voxel, word, [&](uint32_t other, uint32_t flip) {
        if (!set.Test(other)) return true;
        const bool may_have_left = (parity ^ flip) < parity && doubted.Test(other);
        if (may_have_left) may_keep |= (links.Get(other) & (kListed | kUnsure)) != kListed;
        return false;
      });
      if (keep) continue;
      if (may_keep) {
        links.At(voxel) |= kUnsure;
        decided &= !wanted.Contains(layout.VoxelAt(voxel));
      } else {
        set.Clear(voxel);
        removed.push_back(voxel);
      }
    }
  }
  if (!decided) {
    for (const uint32_t voxel : removed) set.Set(voxel);
  }
  return decided;
}

}  // namespace latvox
