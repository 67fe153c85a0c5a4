#include "core/validate/validate.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <algorithm>
#include <bit>
#include <utility>

#include "core/base/sort.h"
#include "core/digitize/crossing.h"

namespace latvox {
namespace {

using Edge = std::pair<Vec3i, size_t>;  // its lower end, and which of the frames it is along

}  // namespace

absl::StatusOr<Verdict> Validate(const SnappedMesh& mesh, const std::vector<Frame>& frames, const VoxelSet& voxels,
                                 const std::atomic<bool>& cancelled) {
  constexpr int32_t kFar = 1 << 28;  // a box that leaves nothing out
  constexpr IndexBox kEverywhere{{-kFar, -kFar, -kFar}, {kFar, kFar, kFar}};
  constexpr size_t kGrain = 256;
  std::vector<std::atomic<uint64_t>> essential(voxels.words());

  using oneapi::tbb::blocked_range;
  std::vector<Edge> tunnels = oneapi::tbb::parallel_reduce(
      blocked_range<size_t>(0, mesh.triangles.size(), kGrain), std::vector<Edge>{},
      [&](const blocked_range<size_t>& part, std::vector<Edge> found) {
        for (size_t t = part.begin(); t < part.end() && !cancelled; ++t) {
          const auto& [v0, v1, v2] = mesh.triangles[t];
          const Triangle triangle{mesh.vertices_lat[v0], mesh.vertices_lat[v1], mesh.vertices_lat[v2]};
          size_t direction = 0;
          const auto judge = [&](const Vec3i& nearer, const Vec3i& farther) {
            const auto a = voxels.Find(nearer + mesh.base_ijk), b = voxels.Find(farther + mesh.base_ijk);
            if (!a && !b) found.push_back({std::min(nearer, farther), direction});
            if (a && b) return;
            if (const auto only = a ? a : b) {
              essential[*only >> 6].fetch_or(uint64_t{1} << (*only & 63), std::memory_order_relaxed);
            }
          };
          for (; direction < frames.size(); ++direction) {
            ForEachCrossing(triangle, frames[direction], kEverywhere, judge, cancelled);
          }
        }
        return found;
      },
      [](std::vector<Edge> a, const std::vector<Edge>& b) {
        a.insert(a.end(), b.begin(), b.end());
        return a;
      });
  SortUnique(tunnels, cancelled);  // triangles may cross the same one
  if (cancelled) return absl::CancelledError("verification cancelled");

  uint64_t kept = 0;
  for (const auto& word : essential) kept += static_cast<uint64_t>(std::popcount(word.load(std::memory_order_relaxed)));
  return Verdict{tunnels.size(), voxels.size() - kept};
}

}  // namespace latvox
