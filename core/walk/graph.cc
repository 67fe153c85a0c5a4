#include "core/walk/graph.h"

#include <algorithm>
#include <cassert>
#include <functional>
#include <utility>

namespace latvox {

WalkGraph::WalkGraph(const Vec3i& first_tile, int level, const IndexBox& mesh_box)
    : first_tile_(first_tile), level_(level), mesh_box_(mesh_box), cubes_(static_cast<size_t>(level) + 1) {}

void WalkGraph::AddTile(const Vec3i& tile_ijk, TilePieces pieces) {
  const std::lock_guard lock(mutex_);
  new_tiles_.push_back({tile_ijk, std::move(pieces)});
}

void WalkGraph::AddCube(const Vec3i& tile_ijk, int level) {
  const std::lock_guard lock(mutex_);
  cubes_[static_cast<size_t>(level)][tile_ijk] = 0;
}

void WalkGraph::Unite() {
  std::sort(new_tiles_.begin(), new_tiles_.end(), [](const Tile& a, const Tile& b) { return a.tile_ijk < b.tile_ijk; });
  points_.assign(1, 0);
  tiles_.reserve(new_tiles_.size());
  for (const Tile& tile : new_tiles_) {
    tiles_[tile.tile_ijk] = {static_cast<uint32_t>(points_.size()), tile.pieces.count()};
    for (uint32_t piece = 0; piece < tile.pieces.count(); ++piece) points_.push_back(tile.pieces.PointsOf(piece));
  }
  for (size_t level = 0; level < cubes_.size(); ++level) {
    for (auto& [tile_ijk, node] : cubes_[level]) {
      node = static_cast<uint32_t>(points_.size());
      points_.push_back(uint64_t{1} << 3 * (static_cast<size_t>(kTileBits) + level));
    }
  }
  roots_.resize(points_.size());
  for (uint32_t node = 0; node < roots_.size(); ++node) roots_[node] = node;
  for (size_t n = 0; n < new_tiles_.size(); ++n) UniteTile(n);
  new_tiles_ = std::vector<Tile>();
  for (size_t level = 0; level < cubes_.size(); ++level) {
    for (const auto& [tile_ijk, node] : cubes_[level]) UniteCube(tile_ijk, static_cast<int>(level), node);
  }
  for (uint32_t node = 0; node < roots_.size(); ++node) roots_[node] = Root(node);
}

// Patches of two tiles correspond by their order. All patches lie in a cube's only piece.
void WalkGraph::UniteTile(size_t n) {
  const auto& [tile_ijk, pieces] = new_tiles_[n];
  const uint32_t first = tiles_.find(tile_ijk)->second.first;
  for (uint32_t piece = 0; piece < pieces.count(); ++piece) {
    if (pieces.IsOutside(piece)) Join(first + piece, kOutside);
  }
  for (size_t axis = 0; axis < 3; ++axis) {
    for (const size_t side : {0U, 1U}) {
      Vec3i beside = tile_ijk;
      beside[axis] += side == 0 ? -1 : 1;
      const std::span<const uint32_t> patches = pieces.Patches(axis, side);
      if (const std::optional<uint32_t> cube = FindCube(beside, 0)) {
        for (const uint32_t piece : patches) Join(first + piece, *cube);
      } else if (const auto other = tiles_.find(beside); side == 1 && other != tiles_.end()) {
        const auto at = std::lower_bound(new_tiles_.begin(), new_tiles_.end(), beside,
                                         [](const Tile& tile, const Vec3i& ijk) { return tile.tile_ijk < ijk; });
        const std::span<const uint32_t> theirs = at->pieces.Patches(axis, 0);
        assert(patches.size() == theirs.size());
        for (size_t patch = 0; patch < patches.size(); ++patch) {
          Join(first + patches[patch], other->second.first + theirs[patch]);
        }
      }
    }
  }
}

// A smaller cube, or a tile, finds this one.
void WalkGraph::UniteCube(const Vec3i& tile_ijk, int level, uint32_t node) {
  const int32_t side = 1 << level;
  const Vec3i low = tile_ijk * kTileSide, high = (tile_ijk + Vec3i{side, side, side}) * kTileSide;
  for (size_t m = 0; m < 3; ++m) {
    if (low[m] < mesh_box_.min[m] || high[m] > mesh_box_.max[m]) Join(node, kOutside);
  }
  for (size_t axis = 0; axis < 3; ++axis) {
    for (const int32_t step : {-1, side}) {
      Vec3i beside = tile_ijk;
      beside[axis] += step;
      if (const std::optional<uint32_t> cube = FindCube(beside, level)) Join(node, *cube);
    }
  }
}

uint32_t WalkGraph::Root(uint32_t node) {
  while (roots_[node] != node) node = roots_[node] = roots_[roots_[node]];
  return node;
}

void WalkGraph::Join(uint32_t a, uint32_t b) {
  a = Root(a);
  b = Root(b);
  roots_[std::max(a, b)] = std::min(a, b);
}

const WalkGraph::TileNodes* WalkGraph::FindTile(const Vec3i& tile_ijk) const {
  const auto found = tiles_.find(tile_ijk);
  return found == tiles_.end() ? nullptr : &found->second;
}

std::optional<uint32_t> WalkGraph::FindCube(const Vec3i& tile_ijk, int level) const {
  if (!Contains(tile_ijk)) return std::nullopt;
  for (int at = level; at <= level_; ++at) {
    const auto& cubes = cubes_[static_cast<size_t>(at)];
    const Vec3i corner = first_tile_ + Shifted(tile_ijk - first_tile_, at) * (1 << at);
    if (const auto found = cubes.find(corner); found != cubes.end()) return found->second;
  }
  return std::nullopt;
}

bool WalkGraph::Contains(const Vec3i& tile_ijk) const {
  for (size_t m = 0; m < 3; ++m) {
    const int32_t relative = tile_ijk[m] - first_tile_[m];
    if (relative < 0 || relative >= 1 << level_) return false;
  }
  return true;
}

std::vector<uint64_t> WalkGraph::Volumes() const {
  std::vector<uint64_t> sums(points_.size());
  for (size_t node = 0; node < points_.size(); ++node) sums[roots_[node]] += points_[node];
  sums[roots_[kOutside]] = 0;
  std::erase(sums, 0);
  std::sort(sums.begin(), sums.end(), std::greater());
  return sums;
}

}  // namespace latvox
