// Casts rays through a scene.
#include <algorithm>
#include <cmath>

#include "client/internal/vec3.h"
#include "client/tool/output/cell_index.h"
#include "client/tool/output/voxel_scene.h"

namespace latvox::client {
namespace {

constexpr int kMaxAhead = 7;  // facets that a ray can leave by: half of at most 14

double Product(const Vec3i& cell, const std::array<double, 3>& v) {
  return cell[0] * v[0] + cell[1] * v[1] + cell[2] * v[2];
}

}  // namespace

// Greedy: from any cell except the nearest, the point lies behind one of the facets, and the step over it comes nearer.
// Opposite facets are tested together.
Vec3i VoxelScene::Nearest(const Vec3d& point, Vec3i cell) const {
  constexpr double kOnFacet = 1e-9;
  for (;;) {
    const Vec3d at = Sum(point, -1, CenterOf(cell));
    Vec3i step{};
    double most = kOnFacet;
    for (const Facet& facet : sides_) {
      const double height = Dot(at, facet.normal), beyond = std::abs(height) - facet.distance;
      if (beyond <= most) continue;
      most = beyond;
      for (size_t m = 0; m < 3; ++m) step[m] = height > 0 ? facet.step[m] : -facet.step[m];
    }
    if (step == Vec3i{}) return cell;
    cell = Plus(cell, step);
  }
}

VoxelScene::Hit VoxelScene::Meet(const Ray& ray, const Vec3i& cell) const {
  Hit hit{-std::numeric_limits<double>::infinity(), cell, 0};
  for (size_t f = 0; f < facets_.size(); ++f) {
    const Facet& facet = facets_[f];
    const double along = Dot(ray.along, facet.normal);
    if (along >= 0) continue;
    const double t = (facet.distance + Product(cell, facet.gradient) - Dot(ray.from, facet.normal)) / along;
    if (t <= hit.t) continue;
    hit.t = t;
    hit.facet = static_cast<int>(f);
  }
  hit.t = std::max(hit.t, 0.0);
  return hit;
}

// Walks a ray from cell to cell through the facet that it leaves by, and skips empty blocks.
class VoxelScene::Walk {
 public:
  Walk(const VoxelScene& scene, const Ray& ray)
      : scene_(scene), ray_(ray), from_(ToLattice(ray.from)), along_(ToLattice(ray.along)) {
    for (size_t m = 0; m < 3; ++m) inverse_[m] = along_[m] == 0 ? 0 : 1 / along_[m];
    for (const Facet& facet : scene.facets_) {
      const double along = Dot(ray.along, facet.normal);
      if (along <= 1e-12 || ahead_ == kMaxAhead) continue;
      ways_[ahead_++] = {(facet.distance - Dot(ray.from, facet.normal)) / along,
                         {facet.gradient[0] / along, facet.gradient[1] / along, facet.gradient[2] / along},
                         facet.step};
    }
  }

  std::optional<Hit> Go() {
    Vec3d low, high;
    for (size_t m = 0; m < 3; ++m) {
      low[m] = scene_.low_[m] - scene_.reach_[m];
      high[m] = scene_.high_[m] - 1 + scene_.reach_[m];
    }
    auto [t, end] = Within(low, high);
    t = std::max(t, 0.0);
    end = std::min(end, ray_.reach);
    if (!(t <= end)) return std::nullopt;
    // In empty space an approximate cell suffices.
    Vec3i cell = Rounded(Sum(from_, t, along_));
    bool exact = false;
    while (t <= end) {
      const Block block = BlockOf(cell);
      if (const double far = block.side > 1 ? Leave(block, t) : t; far > t) {
        t = far;
        cell = Rounded(Sum(from_, t, along_));
        exact = false;
      } else if (!exact) {
        cell = scene_.Nearest(Sum(ray_.from, t, ray_.along), cell);
        exact = true;
      } else if (block.side == 0) {
        const Hit hit = scene_.Meet(ray_, cell);
        return hit.t <= end ? std::optional(hit) : std::nullopt;
      } else {
        StepOn(t, cell);
      }
    }
    return std::nullopt;
  }

 private:
  struct Block {
    Vec3i corner;
    int side;
  };

  // A facet that the ray may leave a cell by, at t = base + cell * gradient.
  struct Way {
    double base;
    std::array<double, 3> gradient;
    Vec3i step;
  };

  Vec3d ToLattice(const Vec3d& v) const {
    return {Dot(scene_.dual_.a, v), Dot(scene_.dual_.b, v), Dot(scene_.dual_.c, v)};
  }

  // Returns the interval of t in which the ray is in a box of lattice coordinates.
  std::pair<double, double> Within(const Vec3d& low, const Vec3d& high) const {
    double in = -std::numeric_limits<double>::infinity(), out = std::numeric_limits<double>::infinity();
    for (size_t m = 0; m < 3; ++m) {
      if (along_[m] == 0) {
        if (from_[m] < low[m] || from_[m] > high[m]) out = -std::numeric_limits<double>::infinity();
        continue;
      }
      const double at_low = (low[m] - from_[m]) * inverse_[m], at_high = (high[m] - from_[m]) * inverse_[m];
      in = std::max(in, std::min(at_low, at_high));
      out = std::min(out, std::max(at_low, at_high));
    }
    return {in, out};
  }

  // Returns the known empty block around the cell. Side 0: the cell is occupied.
  Block BlockOf(const Vec3i& cell) {
    if (const Vec3i tile_ijk = ShiftRight(cell, 6); !known_ || tile_ijk != tile_ijk_) {
      const auto found = scene_.tile_numbers_.find(tile_ijk);
      tile_ = found == scene_.tile_numbers_.end() ? nullptr : &scene_.tiles_[static_cast<size_t>(found->second)];
      tile_ijk_ = tile_ijk;
      known_ = true;
    }
    if (!tile_) return {{cell[0] & ~63, cell[1] & ~63, cell[2] & ~63}, 64};
    const int32_t mask = (*tile_)[BrickInTile(ShiftRight(cell, 3))];
    if (mask >= 0) return {cell, HasVoxel(scene_.masks_[static_cast<size_t>(mask)], cell) ? 0 : 1};
    const int32_t around = 8 * (-mask - 1);
    return {{(cell[0] & ~7) - around, (cell[1] & ~7) - around, (cell[2] & ~7) - around}, 8 + 2 * around};
  }

  // Returns where the ray leaves the points that belong only to cells of the block, or t if it is not among them. The
  // lattice coordinates of a point differ from those of its cell by at most `reach_`.
  double Leave(const Block& block, double t) const {
    Vec3d low, high;
    for (size_t m = 0; m < 3; ++m) {
      low[m] = block.corner[m] - 1 + scene_.reach_[m];
      high[m] = block.corner[m] + block.side - scene_.reach_[m];
    }
    const auto [in, out] = Within(low, high);
    return in <= t ? std::max(t, out) : t;
  }

  void StepOn(double& t, Vec3i& cell) const {
    double first = std::numeric_limits<double>::infinity();
    int by = 0;
    for (int n = 0; n < ahead_; ++n) {
      const Way& way = ways_[static_cast<size_t>(n)];
      const double leave = way.base + Product(cell, way.gradient);
      if (leave >= first) continue;
      first = leave;
      by = n;
    }
    t = std::max(t, first);
    cell = Plus(cell, ways_[static_cast<size_t>(by)].step);
  }

  const VoxelScene& scene_;
  const Ray& ray_;
  const Vec3d from_, along_;  // lattice coordinates
  Vec3d inverse_{};
  std::array<Way, kMaxAhead> ways_;
  int ahead_ = 0;
  bool known_ = false;
  Vec3i tile_ijk_{};
  const Tile* tile_ = nullptr;
};

std::optional<VoxelScene::Hit> VoxelScene::Cast(const Ray& ray) const {
  if (empty()) return std::nullopt;
  return Walk(*this, ray).Go();
}

}  // namespace latvox::client
