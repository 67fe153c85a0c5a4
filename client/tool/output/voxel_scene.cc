#include "client/tool/output/voxel_scene.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "client/internal/vec3.h"
#include "client/tool/output/cell_index.h"
#include "client/tool/output/voronoi_cell.h"

namespace latvox::client {
namespace {

constexpr int kFarthest = 8;    // bricks
constexpr size_t kAcross = 24;  // bricks of a tile and its neighbors
using BrickRows = std::array<std::array<uint32_t, kAcross>, kAcross>;

// Adds all bricks that touch one of these.
void Grow(BrickRows& rows) {
  for (auto& plane : rows) {
    for (uint32_t& row : plane) row |= row << 1 | row >> 1;
    uint32_t before = 0;
    for (size_t y = 0; y < kAcross; ++y) {
      const uint32_t here = plane[y];
      plane[y] |= before | (y + 1 < kAcross ? plane[y + 1] : 0);
      before = here;
    }
  }
  const BrickRows old = rows;
  for (size_t x = 0; x < kAcross; ++x) {
    for (size_t y = 0; y < kAcross; ++y)
      rows[x][y] |= (x > 0 ? old[x - 1][y] : 0) | (x + 1 < kAcross ? old[x + 1][y] : 0);
  }
}

// Returns the bricks of the tile in the middle.
decltype(Brick::mask) Middle(const BrickRows& rows) {
  decltype(Brick::mask) tile{};
  for (size_t n = 0; n < 64; ++n) {
    tile[n / 8] |= uint64_t{rows[8 + n / 8][8 + n % 8] >> 8 & 0xFF} << (8 * (n % 8));
  }
  return tile;
}

// Calls visit(n) for each cell of a mask, 0 <= n < 512.
template <class Visit>
void ForEachBit(const decltype(Brick::mask)& mask, const Visit& visit) {
  for (size_t word = 0; word < mask.size(); ++word) {
    for (uint64_t bits = mask[word]; bits != 0; bits &= bits - 1) {
      visit(word * 64 + static_cast<size_t>(std::countr_zero(bits)));
    }
  }
}

// Returns a pseudorandom rank. The voxel of the lowest rank gives its cell the color.
uint32_t RankOf(const Vec3i& ijk) {
  const auto u = [&](size_t m) { return static_cast<uint32_t>(ijk[m]); };
  return (u(0) * 73856093U ^ u(1) * 19349663U ^ u(2) * 83492791U) * 2654435761U >> 24;
}

}  // namespace

VoxelScene::VoxelScene(const GridTransform& grid, int shift) : shift_(shift) {
  size_ = std::ldexp(std::cbrt(std::abs(Dot(grid.basis.a, Cross(grid.basis.b, grid.basis.c)))), shift);
  const double scale = std::ldexp(1.0, shift) / size_;
  basis_ = {Sum({}, scale, grid.basis.a), Sum({}, scale, grid.basis.b), Sum({}, scale, grid.basis.c)};
  dual_ = Dual(basis_);
  VoronoiCell cell = VoronoiCellOf(basis_);
  bool are_short = true;
  for (const CellFace& face : cell.faces) {
    const Vec3i& w = face.neighbor;
    const Vec3d to = Combine(basis_, {double(w[0]), double(w[1]), double(w[2])});
    const Vec3d n = Unit(to);
    facets_.push_back({w, n, Length(to) / 2, {Dot(basis_.a, n), Dot(basis_.b, n), Dot(basis_.c, n)}});
    if (w > Vec3i{}) sides_.push_back(facets_.back());
    are_short = are_short && std::ranges::all_of(w, [](int32_t along) { return std::abs(along) < 8; });
  }
  if (are_short) {
    steps_.emplace();
    for (const Facet& facet : facets_) steps_->emplace_back(facet.step);
  }
  for (const Vec3d& corner : cell.corners) {
    const Vec3d lattice = {Dot(dual_.a, corner), Dot(dual_.b, corner), Dot(dual_.c, corner)};
    for (size_t m = 0; m < 3; ++m) reach_[m] = std::max(reach_[m], std::abs(lattice[m]));
  }
  corners_ = std::move(cell.corners);
}

// A brick lies within a single brick of the scene.
void VoxelScene::Add(const Brick& brick, std::span<const uint32_t> colors) {
  Vec3i first;
  for (size_t m = 0; m < 3; ++m) first[m] = static_cast<int32_t>((int64_t{brick.brick_ijk[m]} * 8) >> shift_);
  if (!corner_) corner_ = {first[0] & ~63, first[1] & ~63, first[2] & ~63};
  for (size_t m = 0; m < 3; ++m) first[m] -= (*corner_)[m];
  const size_t number = Touch(ShiftRight(first, 3));
  Mask& mask = masks_[number];
  const Mask before = mask;
  const auto set = [&](const Vec3i& cell) { mask[WordInBrick(cell)] |= BitInWord(cell); };
  if (shift_ == 0) {
    for (size_t x = 0; x < 8; ++x) mask[x] |= brick.mask[x];
  } else if (shift_ >= 3) {
    set(first);
  } else {
    ForEachVoxel({{}, brick.mask}, [&](const Vec3i& xyz) { set(Plus(first, ShiftRight(xyz, shift_))); });
  }
  if (!colors.empty()) Paint(brick, colors, first, before, number);
}

// Stores the colors of the brick. The cells of `before` already have colors.
void VoxelScene::Paint(const Brick& brick, std::span<const uint32_t> colors, const Vec3i& first, const Mask& before,
                       size_t number) {
  std::array<uint32_t, kBricks> all;
  all.fill(UINT32_MAX);
  colors_.resize(masks_.size());
  std::vector<uint32_t>& ours = colors_[number];
  const uint32_t* color = ours.data();
  ForEachBit(before, [&](size_t cell) { all[cell] = *color++; });
  color = colors.data();
  const Vec3i corner = {8 * brick.brick_ijk[0], 8 * brick.brick_ijk[1], 8 * brick.brick_ijk[2]};
  ForEachVoxel({{}, brick.mask}, [&](const Vec3i& xyz) {
    uint32_t& cell = all[VoxelInBrick(Plus(first, ShiftRight(xyz, shift_)))];
    cell = std::min(cell, RankOf(Plus(corner, xyz)) << 24 | *color++);
  });
  ours.clear();
  ForEachBit(masks_[number], [&](size_t cell) { ours.push_back(all[cell]); });
}

size_t VoxelScene::Touch(const Vec3i& brick_ijk) {
  for (size_t m = 0; m < 3; ++m) {
    low_[m] = masks_.empty() ? brick_ijk[m] * 8 : std::min(low_[m], brick_ijk[m] * 8);
    high_[m] = masks_.empty() ? brick_ijk[m] * 8 + 8 : std::max(high_[m], brick_ijk[m] * 8 + 8);
  }
  const auto [tile, fresh] = tile_numbers_.try_emplace(ShiftRight(brick_ijk, 3), tiles_.size());
  if (fresh) tiles_.emplace_back().fill(-1);
  int32_t& number = tiles_[tile->second][BrickInTile(brick_ijk)];
  if (number < 0) {
    number = static_cast<int32_t>(masks_.size());
    masks_.push_back({});
  }
  return static_cast<size_t>(number);
}

VoxelScene::Mask VoxelScene::Occupied(const Tile& tile) {
  Mask occupied{};
  for (size_t n = 0; n < tile.size(); ++n) occupied[n / 64] |= uint64_t{tile[n] >= 0} << n % 64;
  return occupied;
}

VoxelScene::Mask VoxelScene::Full(const Tile& tile) const {
  Mask full{};
  for (size_t n = 0; n < tile.size(); ++n) {
    if (tile[n] < 0) continue;
    uint64_t all = ~uint64_t{0};
    for (const uint64_t word : masks_[static_cast<size_t>(tile[n])]) all &= word;
    full[n / 64] |= uint64_t{all == ~uint64_t{0}} << n % 64;
  }
  return full;
}

// Grows the occupied bricks by one brick in all directions, again and again, and once those that are not full.
void VoxelScene::Seal() {
  std::vector<Mask> occupied, full;
  for (const Tile& tile : tiles_) {
    occupied.push_back(Occupied(tile));
    full.push_back(Full(tile));
  }
  const auto around = [this](const Vec3i& tile_ijk, const std::vector<Mask>& bricks) {
    BrickRows rows{};
    for (size_t n = 0; n < 27; ++n) {
      const size_t x = n / 9, y = n / 3 % 3, z = n % 3;
      const auto step = [](size_t place) { return static_cast<int32_t>(place) - 1; };
      const auto found = tile_numbers_.find(Plus(tile_ijk, {step(x), step(y), step(z)}));
      if (found == tile_numbers_.end()) continue;
      for (size_t row = 0; row < 64; ++row) {
        const uint64_t bits = bricks[found->second][row / 8] >> (8 * (row % 8)) & 0xFF;
        rows[8 * x + row / 8][8 * y + row % 8] |= static_cast<uint32_t>(bits << (8 * z));
      }
    }
    return rows;
  };
  outer_ = occupied;
  for (const auto& [tile_ijk, number] : tile_numbers_) {
    if (full[number] != Mask{}) {  // rare on a surface
      BrickRows rows = around(tile_ijk, full);
      for (auto& plane : rows) {
        for (uint32_t& row : plane) row = ~row;
      }
      Grow(rows);
      const Mask near = Middle(rows);
      for (size_t x = 0; x < near.size(); ++x) outer_[number][x] &= near[x];
    }
    BrickRows rows = around(tile_ijk, occupied);
    Tile& tile = tiles_[number];
    for (int far = 2; far <= kFarthest; ++far) {
      Grow(rows);
      const Mask near = Middle(rows);
      for (size_t n = 0; n < tile.size(); ++n) {
        if ((near[n / 64] >> n % 64 & 1) == 0 && tile[n] < 0) tile[n] = -far;
      }
    }
  }
}

int32_t VoxelScene::NumberOf(const Vec3i& brick_ijk) const {
  const auto tile = tile_numbers_.find(ShiftRight(brick_ijk, 3));
  return tile == tile_numbers_.end() ? -1 : tiles_[tile->second][BrickInTile(brick_ijk)];
}

// Takes all cells around the brick for given first. Few bricks of a surface need more.
Brick VoxelScene::ShellOf(const Brick& brick) const {
  if (!steps_) return brick;
  static constexpr Mask kNone{};
  static const Mask kAll = [] {
    Mask all;
    all.fill(~uint64_t{0});
    return all;
  }();
  const auto inside = [&](const auto& mask_at) {
    Mask cells = brick.mask;
    for (auto step = steps_->begin(); step != steps_->end() && cells != kNone; ++step) {
      const Mask behind = step->From(mask_at);
      for (size_t x = 0; x < cells.size(); ++x) cells[x] &= behind[x];
    }
    return cells;
  };
  const auto is_own = [](const Vec3i& at) { return Same(at, {}); };
  Mask cells = inside([&](const Vec3i& at) -> const Mask& { return is_own(at) ? brick.mask : kAll; });
  if (cells == kNone) return brick;
  std::array<const Mask*, 27> around;
  for (int n = 0; n < 27; ++n) {
    const int32_t number = NumberOf(Plus(brick.brick_ijk, {n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1}));
    around[static_cast<size_t>(n)] = number < 0 ? &kNone : &masks_[static_cast<size_t>(number)];
  }
  cells = inside(
      [&](const Vec3i& at) -> const Mask& { return *around[static_cast<size_t>(13 + 9 * at[0] + 3 * at[1] + at[2])]; });
  Brick shell = brick;
  for (size_t x = 0; x < cells.size(); ++x) shell.mask[x] &= ~cells[x];
  return shell;
}

bool VoxelScene::Has(const Vec3i& cell) const {
  const int32_t number = NumberOf(ShiftRight(cell, 3));
  return number >= 0 && HasVoxel(masks_[static_cast<size_t>(number)], cell);
}

uint32_t VoxelScene::ColorOf(const Vec3i& cell) const {
  const auto number = static_cast<size_t>(NumberOf(ShiftRight(cell, 3)));
  const Mask& mask = masks_[number];
  int before = std::popcount(mask[WordInBrick(cell)] & (BitInWord(cell) - 1));
  for (size_t word = 0; word < WordInBrick(cell); ++word) before += std::popcount(mask[word]);
  return colors_[number][static_cast<size_t>(before)] & 0xFFFFFF;
}

Vec3d VoxelScene::CenterOf(const Vec3i& cell) const {
  return Combine(basis_, {double(cell[0]), double(cell[1]), double(cell[2])});
}

}  // namespace latvox::client
