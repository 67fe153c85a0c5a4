#include "client/output/voxel_scene.h"

#include <algorithm>
#include <cmath>

#include "client/output/vec3.h"
#include "client/output/voronoi_cell.h"

namespace latvox::client {
namespace {

constexpr int kFarthest = 8;  // bricks
constexpr int kMaxAhead = 7;  // facets that a ray can leave by: half of the 14 that a cell has at most

Vec3i Plus(const Vec3i& a, const Vec3i& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Vec3i ShiftRight(const Vec3i& v, int by) { return {v[0] >> by, v[1] >> by, v[2] >> by}; }
double Product(const Vec3i& cell, const std::array<double, 3>& v) {
  return cell[0] * v[0] + cell[1] * v[1] + cell[2] * v[2];
}

size_t BrickIn(const Vec3i& tile_of_bricks) {
  return static_cast<size_t>((tile_of_bricks[0] & 7) << 6 | (tile_of_bricks[1] & 7) << 3 | (tile_of_bricks[2] & 7));
}

// Faster than any function of the library.
Vec3i Rounded(const Vec3d& v) {
  constexpr int32_t kBeyond = 1 << 20;
  Vec3i out;
  for (size_t m = 0; m < 3; ++m) out[m] = static_cast<int32_t>(v[m] + (kBeyond + 0.5)) - kBeyond;
  return out;
}

bool Test(const std::array<uint64_t, 8>& mask, const Vec3i& cell) {
  return (mask[static_cast<size_t>(cell[0] & 7)] >> ((cell[1] & 7) << 3 | (cell[2] & 7)) & 1) != 0;
}

}  // namespace

VoxelScene::VoxelScene(const GridTransform& grid, int shift) : shift_(shift) {
  size_ = std::ldexp(std::cbrt(std::abs(Dot(grid.basis.a, Cross(grid.basis.b, grid.basis.c)))), shift);
  const double scale = std::ldexp(1.0, shift) / size_;
  basis_ = {Sum({}, scale, grid.basis.a), Sum({}, scale, grid.basis.b), Sum({}, scale, grid.basis.c)};
  dual_ = Dual(basis_);
  VoronoiCell cell = VoronoiCellOf(basis_);
  for (const CellFace& face : cell.faces) {
    const Vec3i& w = face.neighbor;
    const Vec3d to = Combine(basis_, {double(w[0]), double(w[1]), double(w[2])});
    const Vec3d n = Unit(to);
    facets_.push_back({w, n, Length(to) / 2, {Dot(basis_.a, n), Dot(basis_.b, n), Dot(basis_.c, n)}});
    if (w > Vec3i{}) sides_.push_back(facets_.back());
  }
  for (const Vec3d& corner : cell.corners) {
    const Vec3d lattice = {Dot(dual_.a, corner), Dot(dual_.b, corner), Dot(dual_.c, corner)};
    for (size_t m = 0; m < 3; ++m) reach_[m] = std::max(reach_[m], std::abs(lattice[m]));
  }
  corners_ = std::move(cell.corners);
}

// A brick is part of a single one of the scene.
void VoxelScene::Add(const Brick& brick) {
  Vec3i first;
  for (size_t m = 0; m < 3; ++m) first[m] = static_cast<int32_t>((int64_t{brick.brick_ijk[m]} * 8) >> shift_);
  if (!corner_) corner_ = {first[0] & ~63, first[1] & ~63, first[2] & ~63};
  for (size_t m = 0; m < 3; ++m) first[m] -= (*corner_)[m];
  Mask& mask = Touch(ShiftRight(first, 3));
  const auto set = [&](const Vec3i& cell) {
    mask[static_cast<size_t>(cell[0] & 7)] |= uint64_t{1} << ((cell[1] & 7) << 3 | (cell[2] & 7));
  };
  if (shift_ == 0) {
    for (size_t x = 0; x < 8; ++x) mask[x] |= brick.mask[x];
  } else if (shift_ >= 3) {
    set(first);
  } else {
    ForEachVoxel({{}, brick.mask}, [&](const Vec3i& xyz) { set(Plus(first, ShiftRight(xyz, shift_))); });
  }
}

VoxelScene::Mask& VoxelScene::Touch(const Vec3i& brick_ijk) {
  for (size_t m = 0; m < 3; ++m) {
    low_[m] = masks_.empty() ? brick_ijk[m] * 8 : std::min(low_[m], brick_ijk[m] * 8);
    high_[m] = masks_.empty() ? brick_ijk[m] * 8 + 8 : std::max(high_[m], brick_ijk[m] * 8 + 8);
  }
  const auto [tile, fresh] = tile_numbers_.try_emplace(ShiftRight(brick_ijk, 3), static_cast<int32_t>(tiles_.size()));
  if (fresh) tiles_.emplace_back().fill(-1);
  int32_t& number = tiles_[static_cast<size_t>(tile->second)][BrickIn(brick_ijk)];
  if (number < 0) {
    number = static_cast<int32_t>(masks_.size());
    masks_.push_back({});
  }
  return masks_[static_cast<size_t>(number)];
}

// By growing what is there by one brick in all directions, again and again. A tile's bricks and those of the tiles
// around are 24 rows of 24 rows of 24 bits.
void VoxelScene::Seal() {
  constexpr int kSide = 24;
  using Rows = std::array<std::array<uint32_t, kSide>, kSide>;
  const auto grow = [](Rows& rows) {
    for (auto& plane : rows) {
      for (uint32_t& row : plane) row |= row << 1 | row >> 1;
      for (uint32_t y = 0, before = 0; y < kSide; ++y) {
        const uint32_t here = plane[y];
        plane[y] |= before | (y + 1 < kSide ? plane[y + 1] : 0);
        before = here;
      }
    }
    const Rows old = rows;
    for (size_t x = 0; x < kSide; ++x) {
      for (size_t y = 0; y < kSide; ++y)
        rows[x][y] |= (x > 0 ? old[x - 1][y] : 0) | (x + 1 < kSide ? old[x + 1][y] : 0);
    }
  };
  const auto add = [this](const Vec3i& tile_ijk, const Vec3i& place, Rows& rows) {
    const auto found = tile_numbers_.find(tile_ijk);
    if (found == tile_numbers_.end()) return;
    const Tile& tile = tiles_[static_cast<size_t>(found->second)];
    for (int n = 0; n < kBricks; ++n) {
      if (tile[static_cast<size_t>(n)] < 0) continue;
      rows[static_cast<size_t>(place[0] + (n >> 6))][static_cast<size_t>(place[1] + (n >> 3 & 7))] |=
          uint32_t{1} << (place[2] + (n & 7));
    }
  };
  for (const auto& [tile_ijk, number] : tile_numbers_) {
    Rows rows{};
    for (int n = 0; n < 27; ++n) {
      const Vec3i place = {n / 9, n / 3 % 3, n % 3};
      add(Plus(tile_ijk, {place[0] - 1, place[1] - 1, place[2] - 1}), {8 * place[0], 8 * place[1], 8 * place[2]}, rows);
    }
    Tile& tile = tiles_[static_cast<size_t>(number)];
    for (int far = 2; far <= kFarthest; ++far) {
      grow(rows);
      for (int n = 0; n < kBricks; ++n) {
        const bool near =
            rows[static_cast<size_t>(8 + (n >> 6))][static_cast<size_t>(8 + (n >> 3 & 7))] >> (8 + (n & 7)) & 1;
        if (!near && tile[static_cast<size_t>(n)] < 0) tile[static_cast<size_t>(n)] = -far;
      }
    }
  }
}

bool VoxelScene::Has(const Vec3i& cell) const {
  const auto tile = tile_numbers_.find(ShiftRight(cell, 6));
  if (tile == tile_numbers_.end()) return false;
  const int32_t mask = tiles_[static_cast<size_t>(tile->second)][BrickIn(ShiftRight(cell, 3))];
  return mask >= 0 && Test(masks_[static_cast<size_t>(mask)], cell);
}

Vec3d VoxelScene::CenterOf(const Vec3i& cell) const {
  return Combine(basis_, {double(cell[0]), double(cell[1]), double(cell[2])});
}

// Greedy: from any cell but the nearest, one of the facets has the point behind it, and stepping over it comes nearer.
// Of two facets that are opposite, one is looked at.
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

// One ray on its way: from cell to cell through the facet that it leaves by, and over what is empty at once.
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
    // Where nothing is near, a cell that is about right will do.
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

  // From which t to which the ray is in a box of lattice coordinates.
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

  // What is known to be empty around the cell. Side 0: nothing, the cell is there.
  Block BlockOf(const Vec3i& cell) {
    if (const Vec3i tile_ijk = ShiftRight(cell, 6); !known_ || tile_ijk != tile_ijk_) {
      const auto found = scene_.tile_numbers_.find(tile_ijk);
      tile_ = found == scene_.tile_numbers_.end() ? nullptr : &scene_.tiles_[static_cast<size_t>(found->second)];
      tile_ijk_ = tile_ijk;
      known_ = true;
    }
    if (!tile_) return {{cell[0] & ~63, cell[1] & ~63, cell[2] & ~63}, 64};
    const int32_t mask = (*tile_)[BrickIn(ShiftRight(cell, 3))];
    if (mask >= 0) return {cell, Test(scene_.masks_[static_cast<size_t>(mask)], cell) ? 0 : 1};
    const int32_t around = 8 * (-mask - 1);
    return {{(cell[0] & ~7) - around, (cell[1] & ~7) - around, (cell[2] & ~7) - around}, 8 + 2 * around};
  }

  // Where the ray leaves those points of the block that are in none but its own cells; t if it is not among them. The
  // lattice coordinates of a point differ from those of its cell by `reach_` at most.
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
