#include "core/band/inside.h"

#include <algorithm>

#include "core/base/sort.h"
#include "core/digitize/crossing.h"

namespace latvox {
namespace {

const Frame& FrameAlong(size_t axis) {
  static const std::array<Frame, 3> kFrames{*MakeFrame({1, 0, 0}), *MakeFrame({0, 1, 0}), *MakeFrame({0, 0, 1})};
  return kFrames[axis];
}

Triangle CornersOf(const SnappedMesh& mesh, const std::array<uint32_t, 3>& triangle) {
  return {mesh.vertices_lat[triangle[0]], mesh.vertices_lat[triangle[1]], mesh.vertices_lat[triangle[2]]};
}

// Calls f(ijk) with the lower end of each link along the axis that the triangle crosses and that has its nearer end in
// the box.
template <class F>
void ForEachLink(const Triangle& triangle, size_t axis, const IndexBox& box, const F& f) {
  ForEachCrossing(triangle, FrameAlong(axis), box, [&](const Vec3i& nearer, const Vec3i& farther) {
    f(nearer[axis] < farther[axis] ? nearer : farther);
  });
}

// Bit n of the result: whether an odd number of the bits below n is set.
constexpr uint64_t ParityBelow(uint64_t bits) {
  for (int step = 1; step < 64; step *= 2) bits ^= bits << step;
  return bits << 1;
}

// Returns the first and the last multiple of kTileSide, in voxels, from `low` to `high` lattice units.
std::pair<int32_t, int32_t> TileCorners(int32_t low, int32_t high) {
  constexpr int kShift = kTileBits + kSubvoxelBits;
  return {((low - 1) >> kShift) + 1, high >> kShift};
}

}  // namespace

CornerLines::CornerLines(const SnappedMesh& mesh, StopSignal stop) {
  for (const std::array<uint32_t, 3>& indices : mesh.triangles) {
    if (stop.Stopped()) return;
    const Triangle triangle = CornersOf(mesh, indices);
    const auto range = [&](size_t m) { return std::minmax({triangle[0][m], triangle[1][m], triangle[2][m]}); };
    const auto [low_i, high_i] = range(0);
    const auto [low_j, high_j] = range(1);
    const auto [first_i, last_i] = TileCorners(low_i, high_i);
    const auto [first_j, last_j] = TileCorners(low_j, high_j);
    if (first_i > last_i || first_j > last_j) continue;
    const auto [low_k, high_k] = range(2);
    for (int32_t i = first_i * kTileSide; i <= last_i * kTileSide && !stop.Stopped(); i += kTileSide) {
      for (int32_t j = first_j * kTileSide; j <= last_j * kTileSide; j += kTileSide) {
        const IndexBox line{{i, j, (low_k >> kSubvoxelBits) - 1}, {i + 1, j + 1, (high_k >> kSubvoxelBits) + 3}};
        ForEachLink(triangle, 2, line, [&](const Vec3i& ijk) { crossings_[{i, j}].push_back(ijk[2]); });
      }
    }
  }
  for (auto& [line, after] : crossings_) Sort(after, stop);
}

bool CornerLines::IsInside(const Vec3i& tile_min) const {
  const auto line = crossings_.find({tile_min[0], tile_min[1]});
  if (line == crossings_.end()) return false;
  const std::vector<int32_t>& after = line->second;
  return (std::lower_bound(after.begin(), after.end(), tile_min[2]) - after.begin()) % 2 != 0;
}

// Goes along i from the corner, from these points along j, and from those along k. The shift in ParityBelow leaves out
// links that lead out of the tile, because their lower end is the last voxel, or comes before the first.
void FindInside(const SnappedMesh& mesh, std::span<const uint32_t> triangles, const Vec3i& tile_min, bool corner_inside,
                StopSignal stop, TileMask& inside) {
  uint64_t along_i = 0;
  std::array<uint64_t, kTileSide> along_j{};
  inside.fill(0);
  const auto box = [&](const Vec3i& side) { return IndexBox{tile_min, tile_min + side}; };
  const auto cross = [](int32_t at, uint64_t& bits) {
    if (at >= 0) bits ^= uint64_t{1} << at;
  };
  for (const uint32_t t : triangles) {
    if (stop.Stopped()) return;
    const Triangle triangle = CornersOf(mesh, mesh.triangles[t]);
    ForEachLink(triangle, 0, box({kTileSide, 1, 1}), [&](const Vec3i& ijk) { cross(ijk[0] - tile_min[0], along_i); });
    ForEachLink(triangle, 1, box({kTileSide, kTileSide, 1}), [&](const Vec3i& ijk) {
      cross(ijk[1] - tile_min[1], along_j[static_cast<size_t>(ijk[0] - tile_min[0])]);
    });
    ForEachLink(triangle, 2, box({kTileSide, kTileSide, kTileSide}), [&](const Vec3i& ijk) {
      const Vec3i at = ijk - tile_min;
      cross(at[2], inside[static_cast<size_t>(at[0] << kTileBits | at[1])]);
    });
  }
  const auto spread = [](bool first, uint64_t bits) { return ParityBelow(bits) ^ (first ? ~uint64_t{0} : 0); };
  along_i = spread(corner_inside, along_i);
  for (size_t i = 0; i < kTileSide; ++i) {
    along_j[i] = spread(along_i >> i & 1, along_j[i]);
    for (size_t j = 0; j < kTileSide; ++j) {
      uint64_t& row = inside[i << kTileBits | j];
      row = spread(along_j[i] >> j & 1, row);
    }
  }
}

}  // namespace latvox
