#include "client/tool/output/beam.h"

#include <algorithm>
#include <cmath>

#include "client/internal/vec3.h"
#include "client/tool/output/cell_index.h"

namespace latvox::client {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double Product(const Vec3i& cell, const std::array<double, 3>& v) {
  return cell[0] * v[0] + cell[1] * v[1] + cell[2] * v[2];
}

Vec3d ToLattice(const Basis& dual, const Vec3d& v) { return {Dot(dual.a, v), Dot(dual.b, v), Dot(dual.c, v)}; }

}  // namespace

VoxelScene::Beam::Beam(const VoxelScene& scene, const Vec3d& along)
    : scene_(scene), along_(along), lattice_along_(ToLattice(scene.dual_, along)) {
  for (size_t m = 0; m < 3; ++m) {
    inverse_[m] = lattice_along_[m] == 0 ? 0 : 1 / lattice_along_[m];
    low_[m] = scene.low_[m] - scene.reach_[m];
    high_[m] = scene.high_[m] - 1 + scene.reach_[m];
  }
  for (size_t f = 0; f < scene.facets_.size(); ++f) {
    const Facet& facet = scene.facets_[f];
    const double part = Dot(along, facet.normal);
    if (part < 0 && behind_ < kMaxAhead) entries_[behind_++] = {part, static_cast<int>(f)};
    if (part > 1e-12 && ahead_ < kMaxAhead) {
      ways_[ahead_++] = {part, facet.distance, facet.normal, facet.gradient, facet.step, {}};
    }
  }
  for (size_t by = 0; by < ahead_; ++by) {
    for (size_t n = 0; n < ahead_; ++n) {
      ways_[by].delays[n] = Product(ways_[by].step, ways_[n].gradient) / ways_[n].along;
    }
  }
}

// Walks from cell to cell through the facet that the ray leaves by, and skips empty blocks.
std::optional<VoxelScene::Hit> VoxelScene::Beam::Cast(const Vec3d& start, double reach) {
  if (scene_.empty()) return std::nullopt;
  const Vec3d from = ToLattice(scene_.dual_, start);
  auto [t, end] = Within(from, low_, high_);
  t = std::max(t, 0.0);
  end = std::min(end, reach);
  if (!(t <= end)) return std::nullopt;  // beside the box, whose cells alone Rounded can tell
  // In empty space an approximate cell suffices.
  Vec3i cell = Rounded(Sum(from, t, lattice_along_));
  bool exact = false;
  while (t <= end) {
    Visit(ShiftRight(cell, 3));
    if (const double far = mask_ ? t : Leave(from, t); far > t) {
      t = far;
      cell = Rounded(Sum(from, t, lattice_along_));
      exact = false;
    } else if (!exact) {
      cell = Nearest(Sum(start, t, along_), cell);
      exact = true;
    } else if (mask_ && HasVoxel(*mask_, cell)) {
      const Hit hit = Meet(start, cell);
      return hit.t <= end ? std::optional(hit) : std::nullopt;
    } else {
      Walk(start, end, t, cell);
    }
  }
  return std::nullopt;
}

// Returns the interval of t in which the ray is in a box of lattice coordinates.
VoxelScene::Beam::Interval VoxelScene::Beam::Within(const Vec3d& from, const Vec3d& low, const Vec3d& high) const {
  double in = -kInfinity, out = kInfinity;
  for (size_t m = 0; m < 3; ++m) {
    if (lattice_along_[m] == 0) {
      if (from[m] < low[m] || from[m] > high[m]) out = -kInfinity;
      continue;
    }
    const double at_low = (low[m] - from[m]) * inverse_[m], at_high = (high[m] - from[m]) * inverse_[m];
    in = std::max(in, std::min(at_low, at_high));
    out = std::min(out, std::max(at_low, at_high));
  }
  return {in, out};
}

// Finds the brick, or the empty block that is known around it.
void VoxelScene::Beam::Visit(const Vec3i& brick_ijk) {
  if (known_ && Same(brick_ijk, brick_ijk_)) return;
  const Vec3i tile_ijk = ShiftRight(brick_ijk, 3);
  if (!known_ || !Same(tile_ijk, tile_ijk_)) {
    const auto found = scene_.tile_numbers_.find(tile_ijk);
    tile_ = found == scene_.tile_numbers_.end() ? nullptr : &scene_.tiles_[static_cast<size_t>(found->second)];
  }
  known_ = true;
  brick_ijk_ = brick_ijk;
  tile_ijk_ = tile_ijk;
  const int32_t number = tile_ ? (*tile_)[BrickInTile(brick_ijk)] : -1;
  mask_ = number >= 0 ? &scene_.masks_[static_cast<size_t>(number)] : nullptr;
  const int32_t around = mask_ ? 0 : 8 * (-number - 1);
  side_ = tile_ ? 8 + 2 * around : 64;
  for (size_t m = 0; m < 3; ++m) corner_[m] = tile_ ? 8 * brick_ijk[m] - around : 64 * tile_ijk[m];
}

// Returns where the ray leaves the points that belong only to cells of the empty block, or t if it is not among them.
// The lattice coordinates of a point differ from those of its cell by at most `reach_`.
double VoxelScene::Beam::Leave(const Vec3d& from, double t) const {
  Vec3d low, high;
  for (size_t m = 0; m < 3; ++m) {
    low[m] = corner_[m] - 1 + scene_.reach_[m];
    high[m] = corner_[m] + side_ - scene_.reach_[m];
  }
  const auto [in, out] = Within(from, low, high);
  return in <= t ? std::max(t, out) : t;
}

// Walks from the cell of point t to the next one with a voxel, or in another brick, or beyond the end. A brick has at
// most 22 steps, so the sums of `leave` are off by some 1e-14 of a cell, which kOnFacet exceeds by far.
void VoxelScene::Beam::Walk(const Vec3d& start, double end, double& t, Vec3i& cell) const {
  std::array<double, kMaxAhead> leave;
  for (size_t n = 0; n < ahead_; ++n) {
    const Way& way = ways_[n];
    leave[n] = (way.distance + Product(cell, way.gradient) - Dot(start, way.normal)) / way.along;
  }
  do {
    size_t by = 0;
    for (size_t n = 1; n < ahead_; ++n) by = leave[n] < leave[by] ? n : by;
    t = std::max(t, leave[by]);
    cell = Plus(cell, ways_[by].step);
    for (size_t n = 0; n < ahead_; ++n) leave[n] += ways_[by].delays[n];
  } while (t <= end && mask_ && Same(ShiftRight(cell, 3), brick_ijk_) && !HasVoxel(*mask_, cell));
}

// Returns the cell of a point. Greedy: from any cell except the nearest, the point lies behind one of the facets, and
// the step over it comes nearer. Opposite facets are tested together.
Vec3i VoxelScene::Beam::Nearest(const Vec3d& point, Vec3i cell) const {
  constexpr double kOnFacet = 1e-9;
  for (;;) {
    const Vec3d at = Sum(point, -1, scene_.CenterOf(cell));
    Vec3i step{};
    double most = kOnFacet;
    for (const Facet& facet : scene_.sides_) {
      const double height = Dot(at, facet.normal), beyond = std::abs(height) - facet.distance;
      if (beyond <= most) continue;
      most = beyond;
      for (size_t m = 0; m < 3; ++m) step[m] = height > 0 ? facet.step[m] : -facet.step[m];
    }
    if (Same(step, {})) return cell;
    cell = Plus(cell, step);
  }
}

VoxelScene::Hit VoxelScene::Beam::Meet(const Vec3d& from, const Vec3i& cell) const {
  Hit hit{-kInfinity, cell, 0};
  for (size_t n = 0; n < behind_; ++n) {
    const auto [along, f] = entries_[n];
    const Facet& facet = scene_.facets_[static_cast<size_t>(f)];
    const double t = (facet.distance + Product(cell, facet.gradient) - Dot(from, facet.normal)) / along;
    if (t <= hit.t) continue;
    hit.t = t;
    hit.facet = f;
  }
  hit.t = std::max(hit.t, 0.0);
  return hit;
}

}  // namespace latvox::client
