#include "core/verify/verify.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstdint>
#include <iterator>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/metered.h"
#include "core/base/sort.h"
#include "core/digitize/crossing.h"

namespace latvox {
namespace {

// Links, each a number, in pieces, because a single array is copied as it grows, for longer than a job may take to
// stop.
class LinkList {
 public:
  // The link from `low` along the n-th frame. Local coordinates, not far outside of `box`.
  void Add(const Vec3i& low, size_t n, const IndexBox& box) {
    constexpr int kBits = 18, kFrameBits = 4, kOutside = 64;
    static_assert(kMaxExtent + 2 * kOutside < 1 << kBits && kMaxPairs <= 1 << kFrameBits);
    uint64_t link = n;
    for (size_t m = 0; m < 3; ++m) link = link << kBits | static_cast<uint64_t>(low[m] - box.min[m] + kOutside);
    if (pieces_.empty() || pieces_.back().size() == kPiece) pieces_.emplace_back();
    pieces_.back().push_back(link);
  }

  void Add(LinkList&& more) { std::move(more.pieces_.begin(), more.pieces_.end(), std::back_inserter(pieces_)); }

  // Returns the number of distinct links, and empties the list.
  size_t Count(StopSignal stop) {
    std::vector<uint64_t> links;
    links.reserve(pieces_.size() * kPiece);
    for (auto& piece : pieces_) {
      if (!stop.Stopped()) links.insert(links.end(), piece.begin(), piece.end());
      piece = std::vector<uint64_t>();  // {} would keep its memory
    }
    SortUnique(links, stop);
    return links.size();
  }

 private:
  static constexpr size_t kPiece = size_t{1} << 16;
  std::vector<std::vector<uint64_t>> pieces_;
};

// A place of triangles.
struct Place {
  Triangle corners;  // ascending
  uint32_t triangle;
  bool operator<(const Place& other) const {
    return std::tie(corners, triangle) < std::tie(other.corners, other.triangle);
  }
};

bool IsLong(const Triangle& corners) {
  constexpr int32_t kLong = 16 * kLatticeUnit;
  const auto reaches = [&](size_t m) {
    const auto [low, high] = std::minmax({corners[0][m], corners[1][m], corners[2][m]});
    return high - low >= kLong;
  };
  return reaches(0) || reaches(1) || reaches(2);
}

// Returns which triangles need no scan, because another one has the same corners: the same links cross both, whatever
// the order of the corners. Only long triangles count, which cross many links, so that a fine mesh costs no sorting.
std::vector<bool> FindRepeated(const SnappedMesh& mesh, StopSignal stop) {
  std::vector<Place> places;
  for (size_t t = 0; t < mesh.triangles.size() && !stop.Stopped(); ++t) {
    Triangle corners = mesh.TriangleAt(t);
    if (!IsLong(corners)) continue;
    std::sort(corners.begin(), corners.end());
    places.push_back({corners, static_cast<uint32_t>(t)});
  }
  Sort(places, stop);
  std::vector<bool> repeated(mesh.triangles.size());
  for (size_t n = 1; n < places.size(); ++n) {
    if (places[n].corners == places[n - 1].corners) repeated[places[n].triangle] = true;
  }
  return repeated;
}

}  // namespace

absl::StatusOr<Verdict> CountTunnels(const SnappedMesh& mesh, const std::vector<Frame>& frames, const VoxelSet& voxels,
                                     StopSignal stop) {
  constexpr int32_t kFar = 1 << 28;  // a box that contains everything
  constexpr IndexBox kEverywhere{{-kFar, -kFar, -kFar}, {kFar, kFar, kFar}};
  constexpr size_t kGrain = 256;
  std::vector<std::atomic<uint64_t>> essential(voxels.words());
  const std::vector<bool> repeated = FindRepeated(mesh, stop);

  using oneapi::tbb::blocked_range;
  oneapi::tbb::enumerable_thread_specific<LinkList> found;
  MeteredFor(blocked_range<size_t>(0, mesh.triangles.size(), kGrain), [&](const blocked_range<size_t>& part) {
    LinkList& uncovered = found.local();
    for (size_t t = part.begin(); t < part.end() && !stop.Stopped(); ++t) {
      if (repeated[t]) continue;
      const Triangle triangle = mesh.TriangleAt(t);
      size_t direction = 0;
      const auto judge = [&](const Vec3i& nearer, const Vec3i& farther) {
        const auto a = voxels.Find(nearer + mesh.base_ijk), b = voxels.Find(farther + mesh.base_ijk);
        if (!a && !b) uncovered.Add(std::min(nearer, farther), direction, mesh.box);
        if (a && b) return;
        if (const auto only = a ? a : b) {
          essential[*only >> 6].fetch_or(uint64_t{1} << (*only & 63), std::memory_order_relaxed);
        }
      };
      for (; direction < frames.size(); ++direction) {
        ForEachCrossing(triangle, frames[direction], kEverywhere, judge, stop);
      }
    }
  });
  LinkList uncovered;
  for (LinkList& some : found) uncovered.Add(std::move(some));
  const size_t tunnels = uncovered.Count(stop);  // triangles may cross the same link
  if (stop.Stopped()) return absl::CancelledError("verification cancelled");

  uint64_t kept = 0;
  for (const auto& word : essential) kept += static_cast<uint64_t>(std::popcount(word.load(std::memory_order_relaxed)));
  return Verdict{tunnels, voxels.size() - kept};
}

}  // namespace latvox
