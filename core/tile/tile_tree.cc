#include "core/tile/tile_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace latvox {
namespace {

// A box in fixed-point lattice coordinates, closed.
struct Box {
  Vec3i min, max;
};

Box BoxOf(const Vec3i& tile_ijk, int level, const Vec3i& margin) {
  Box box;
  for (size_t m = 0; m < 3; ++m) {
    box.min[m] = (tile_ijk[m] * kTileSide - margin[m]) * kLatticeUnit;
    box.max[m] = ((tile_ijk[m] + (1 << level)) * kTileSide + margin[m]) * kLatticeUnit;
  }
  return box;
}

bool Overlap(const Box& a, const Box& b) {
  for (size_t m = 0; m < 3; ++m) {
    if (a.max[m] < b.min[m] || b.max[m] < a.min[m]) return false;
  }
  return true;
}

Box BoxOf(const std::array<Vec3i, 3>& v) {
  Box box{v[0], v[0]};
  for (size_t n = 1; n < 3; ++n) {
    for (size_t m = 0; m < 3; ++m) {
      box.min[m] = std::min(box.min[m], v[n][m]);
      box.max[m] = std::max(box.max[m], v[n][m]);
    }
  }
  return box;
}

Vec3d ToDouble(const Vec3i& v) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

// Whether `axis` separates the triangle from the box, with slack for rounding: keeping too many triangles is harmless.
bool Separates(const Vec3d& axis, const std::array<Vec3d, 3>& v, const Vec3d& half) {
  const double p0 = Dot(axis, v[0]), p1 = Dot(axis, v[1]), p2 = Dot(axis, v[2]);
  double radius = 0;
  for (size_t m = 0; m < 3; ++m) radius += std::abs(axis[m]) * half[m];
  radius *= 1 + 1e-9;
  return std::min({p0, p1, p2}) > radius || std::max({p0, p1, p2}) < -radius;
}

// Separating axes between a triangle and a box whose bounding boxes overlap already.
bool MayMeet(const std::array<Vec3i, 3>& triangle, const Box& box) {
  const Vec3d low = ToDouble(box.min), high = ToDouble(box.max);
  const Vec3d center = (low + high) * 0.5, half = (high - low) * 0.5;
  std::array<Vec3d, 3> v;
  for (size_t n = 0; n < 3; ++n) v[n] = ToDouble(triangle[n]) - center;
  const std::array<Vec3d, 3> edges{v[1] - v[0], v[2] - v[1], v[0] - v[2]};
  if (Separates(Cross(edges[0], edges[1]), v, half)) return false;
  for (const Vec3d& e : edges) {
    if (Separates({0, -e[2], e[1]}, v, half) || Separates({e[2], 0, -e[0]}, v, half) ||
        Separates({-e[1], e[0], 0}, v, half)) {
      return false;
    }
  }
  return true;
}

// Below this size, bounding boxes decide well enough.
constexpr int32_t kSmallTriangle = kTileSide / 4 * kLatticeUnit;

bool IsSmall(const Box& box) {
  const Vec3i side = box.max - box.min;
  return std::max({side[0], side[1], side[2]}) <= kSmallTriangle;
}

}  // namespace

bool TileTree::IsWanted(const TileNode& node) const {
  for (size_t m = 0; m < 3; ++m) {
    const int64_t low = int64_t{node.tile_ijk[m]} * kTileSide;
    const int64_t high = low + (int64_t{kTileSide} << node.level);
    if (high <= region_.min[m] || region_.max[m] <= low) return false;
  }
  return true;
}

std::optional<TileNode> TileTree::Root() const {
  // The cube begins at the lowest tile of the whole mesh, whatever the region, so that the order is always the same.
  TileNode root{{}, 0, {}, 0, 1};
  int32_t tiles = 1;
  for (size_t m = 0; m < 3; ++m) {
    root.tile_ijk[m] = mesh_.box.min[m] >> kTileBits;
    tiles = std::max(tiles, ((mesh_.box.max[m] - 1) >> kTileBits) - root.tile_ijk[m] + 1);
  }
  while ((1 << root.level) < tiles) ++root.level;
  if (!IsWanted(root)) return std::nullopt;
  root.triangles.resize(mesh_.triangles.size());
  std::iota(root.triangles.begin(), root.triangles.end(), 0U);
  return root;
}

std::vector<TileNode> TileTree::Children(const TileNode& node) const {
  std::vector<TileNode> children;
  std::vector<Box> boxes;
  const int level = node.level - 1;
  for (int32_t n = 0; n < 8; ++n) {
    const Vec3i step{n >> 2 & 1, n >> 1 & 1, n & 1};
    TileNode child{node.tile_ijk + step * (1 << level), level, {}, 0, 0};
    if (!IsWanted(child)) continue;
    boxes.push_back(BoxOf(child.tile_ijk, level, margin_));
    children.push_back(std::move(child));
  }
  for (uint32_t t : node.triangles) {
    const auto& [v0, v1, v2] = mesh_.triangles[t];
    const std::array<Vec3i, 3> v{mesh_.vertices_lat[v0], mesh_.vertices_lat[v1], mesh_.vertices_lat[v2]};
    const Box bounds = BoxOf(v);
    const bool small = IsSmall(bounds);
    for (size_t n = 0; n < children.size(); ++n) {
      if (Overlap(bounds, boxes[n]) && (small || MayMeet(v, boxes[n]))) children[n].triangles.push_back(t);
    }
  }
  std::erase_if(children, [](const TileNode& child) { return child.triangles.empty(); });

  size_t total = 0;
  for (const TileNode& child : children) total += child.triangles.size();
  double progress = node.progress;
  for (TileNode& child : children) {
    child.progress = progress;
    child.share = node.share * static_cast<double>(child.triangles.size()) / static_cast<double>(total);
    progress += child.share;
  }
  return children;
}

}  // namespace latvox
