#include "core/voxelizer/shard.h"

#include <oneapi/tbb/blocked_range.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <limits>
#include <utility>
#include <vector>

#include "core/base/metered.h"
#include "core/tree/tile_tree.h"

namespace latvox {
namespace {

constexpr int kMaxLevels = 7;  // of octants: 128 along an axis
constexpr int kTileUnitBits = kTileBits + kSubvoxelBits;

// The cost of a triangle in a tile besides its area: about 90 ns; a voxel costs 15 ns.
constexpr uint64_t kVoxelsPerTriangle = 6;

// A triangle's weight is spread over n^2 equal pieces, no larger than octants unless that needs more pieces than this.
constexpr uint64_t kMaxPieces = 1 << 21;

// Vertices of the mesh, in units from the corner of the lowest tile.
struct Corners {
  Vec3i a, b, c;
};

using Vec3l = Vec<int64_t, 3>;

Vec3l Wide(const Vec3i& v) { return {v[0], v[1], v[2]}; }

// The number of links that a triangle crosses along the direction in which it crosses most: about its voxels. Where
// that weighs less than the constant cost of a triangle, the sum over the axes is close enough.
uint64_t VoxelsOf(const Vec3i& e, const Vec3i& f, const std::vector<Vec3l>& directions) {
  constexpr int kAreaBits = 1 + 2 * kSubvoxelBits;
  const Vec3l normal = Cross(Wide(e), Wide(f));  // its length is twice the area
  const int64_t sum = std::abs(normal[0]) + std::abs(normal[1]) + std::abs(normal[2]);
  if (static_cast<uint64_t>(sum >> kAreaBits) < kVoxelsPerTriangle) return static_cast<uint64_t>(sum >> kAreaBits);
  int64_t most = 0;
  for (const Vec3l& q : directions) most = std::max(most, std::abs(Dot(normal, q)));
  return static_cast<uint64_t>(most >> kAreaBits);
}

int32_t LongestOf(const Vec3i& e, const Vec3i& f) {
  int32_t longest = 0;
  for (size_t m = 0; m < 3; ++m) longest = std::max({longest, std::abs(e[m]), std::abs(f[m]), std::abs(f[m] - e[m])});
  return longest;
}

// The weights of the cubes of tiles that split the order, in that order.
class CellWeights {
 public:
  CellWeights(const SnappedMesh& mesh, const std::vector<Frame>& frames, const IndexBox& region,
              const std::optional<WorldBox>& bounds)
      : mesh_(mesh),
        bounds_(bounds),
        levels_(TileCubeLevel(mesh.box)),
        shift_(3 * std::max(0, levels_ - kMaxLevels)),
        weights_(size_t{1} << 3 * std::min(levels_, kMaxLevels)) {
    for (const Frame& frame : frames) directions_.push_back(Wide(frame.q));
    for (size_t m = 0; m < 3; ++m) {
      low_[m] = mesh.box.min[m] >> kTileBits;
      high_[m] = ((mesh.box.max[m] - 1) >> kTileBits) - low_[m];
      first_[m] = (region.min[m] >> kTileBits) - low_[m];
      last_[m] = ((region.max[m] - 1) >> kTileBits) - low_[m];
    }
    const uint64_t pieces = kMaxPieces / std::max<uint64_t>(mesh.triangles.size(), 1);
    while (static_cast<uint64_t>(most_) * static_cast<uint64_t>(most_) < pieces) ++most_;
  }

  void AddTriangles(size_t begin, size_t end);

  TileSpan SpanOf(const Shard& shard) const;

 private:
  // Neighbors in a mesh mostly lie in one octant. Their weights are added up before they go where all threads write.
  struct Sum {
    size_t octant = 0;
    uint64_t weight = 0;
  };
  void Add(const Corners& corners, Sum& sum);
  void AddPoint(const Vec3i& point, uint64_t weight, Sum& sum);
  void Flush(Sum& sum) { weights_[sum.octant].fetch_add(std::exchange(sum.weight, 0), std::memory_order_relaxed); }

  const SnappedMesh& mesh_;
  const std::optional<WorldBox>& bounds_;
  std::vector<Vec3l> directions_;
  const int levels_, shift_;                 // of the cube of all tiles; from a tile's number to its octant's
  Vec3i low_{}, high_{}, first_{}, last_{};  // tiles; all except low_ are relative to it
  int32_t most_ = 1;                         // pieces along an edge
  std::vector<std::atomic<uint64_t>> weights_;
};

void CellWeights::AddTriangles(size_t begin, size_t end) {
  const Vec3i corner = low_ * (1 << kTileUnitBits);
  Sum sum;
  for (size_t t = begin; t < end; ++t) {
    const auto& [a, b, c] = mesh_.triangles[t];
    Add({mesh_.vertices_lat[a] - corner, mesh_.vertices_lat[b] - corner, mesh_.vertices_lat[c] - corner}, sum);
  }
  Flush(sum);
}

// The pieces are n (n + 1) / 2 triangles in the whole triangle's orientation, and n (n - 1) / 2 turned by half a turn.
// A piece counts at its centroid.
void CellWeights::Add(const Corners& corners, Sum& sum) {
  const Vec3i e = corners.b - corners.a, f = corners.c - corners.a;
  const int32_t n = std::min((LongestOf(e, f) >> (kTileUnitBits + shift_ / 3)) + 1, most_);
  const uint64_t voxels = VoxelsOf(e, f, directions_);
  if (n == 1) {
    Vec3i point = corners.a;
    for (size_t m = 0; m < 3; ++m) point[m] += (e[m] + f[m]) / 3;
    return AddPoint(point, voxels + kVoxelsPerTriangle, sum);
  }
  const uint64_t weight = voxels / (static_cast<uint64_t>(n) * static_cast<uint64_t>(n)) + kVoxelsPerTriangle;
  const auto add_piece = [&](int64_t along_e, int64_t along_f) {
    Vec3i point = corners.a;
    for (size_t m = 0; m < 3; ++m) point[m] += static_cast<int32_t>((along_e * e[m] + along_f * f[m]) / (3 * n));
    AddPoint(point, weight, sum);
  };
  for (int32_t i = 0; i < n; ++i) {
    for (int32_t j = 0; j < n - i; ++j) {
      add_piece(3 * i + 1, 3 * j + 1);
      if (j < n - i - 1) add_piece(3 * i + 2, 3 * j + 2);
    }
  }
}

void CellWeights::AddPoint(const Vec3i& point, uint64_t weight, Sum& sum) {
  Vec3i tile;
  for (size_t m = 0; m < 3; ++m) {
    tile[m] = std::clamp(point[m] >> kTileUnitBits, 0, high_[m]);
    if (tile[m] < first_[m] || tile[m] > last_[m]) return;
  }
  if (bounds_ && !bounds_->Contains(Shifted(point, kSubvoxelBits) + low_ * kTileSide + mesh_.base_ijk)) return;
  const auto octant = static_cast<size_t>(TileNumber(tile) >> shift_);
  if (octant != sum.octant) {
    Flush(sum);
    sum.octant = octant;
  }
  sum.weight += weight;
}

// An octant belongs to the shard with the middle of its weight. The sums never fall, so shards are in order, even where
// weights are 0.
TileSpan CellWeights::SpanOf(const Shard& shard) const {
  using Wide = unsigned __int128;
  Wide total = 0, before = 0;
  for (const auto& weight : weights_) total += weight;
  constexpr uint64_t kNone = std::numeric_limits<uint64_t>::max();
  TileSpan span = {kNone, kNone};
  for (size_t octant = 0; octant < weights_.size(); ++octant) {
    const uint64_t weight = weights_[octant];
    const Wide owner = total == 0 ? 0 : (2 * before + weight) * shard.count / (2 * total);
    const uint64_t number = static_cast<uint64_t>(octant) << shift_;
    if (owner >= shard.index) span.begin = std::min(span.begin, number);
    if (owner > shard.index) span.end = std::min(span.end, number);
    before += weight;
  }
  if (shard.index + 1 == shard.count) span.end = kNone;
  return span;
}

TileSpan SpanOf(const Shard& shard, const SnappedMesh& mesh, const std::vector<Frame>& frames, const IndexBox& region,
                const std::optional<WorldBox>& bounds, StopSignal stop) {
  if (shard.count == 1) return {};
  CellWeights weights(mesh, frames, region, bounds);
  constexpr size_t kGrain = 1024;  // triangles for each task
  using Part = oneapi::tbb::blocked_range<size_t>;
  MeteredFor(Part(0, mesh.triangles.size(), kGrain), [&](const Part& part) {
    if (!stop.Stopped()) weights.AddTriangles(part.begin(), part.end());
  });
  return weights.SpanOf(shard);
}

}  // namespace

TileSpan SpanOf(const Part& part, const SnappedMesh& mesh, const std::vector<Frame>& frames, const IndexBox& region,
                const std::optional<WorldBox>& bounds, StopSignal stop) {
  TileSpan span = part.shard ? SpanOf(*part.shard, mesh, frames, region, bounds, stop) : TileSpan{};
  if (part.resume_after) {
    const Vec3i low = Shifted(mesh.box.min + mesh.base_ijk, kTileBits);
    span.begin = std::max(span.begin, TileNumber(*part.resume_after - low) + 1);
  }
  return span;
}

}  // namespace latvox
