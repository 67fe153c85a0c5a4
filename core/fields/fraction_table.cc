#include "core/fields/fraction_table.h"

#include <algorithm>
#include <bit>

#include "core/request/fields.h"

namespace latvox {
namespace {

constexpr int32_t FloorDiv(int32_t n, int32_t d) { return n / d - (n % d < 0 ? 1 : 0); }
constexpr int32_t CeilDiv(int32_t n, int32_t d) { return -FloorDiv(-n, d); }

bool IsInTile(int32_t coordinate) { return static_cast<uint32_t>(coordinate) < uint32_t{kTileSide}; }

// The bits `first` .. `last` of a word.
constexpr uint64_t Bits(int32_t first, int32_t last) {
  return ~uint64_t{0} >> (kTileSide - 1 - (last - first)) << first;
}

}  // namespace

void FractionTable::Begin(const CellPoints& cell, const Vec3i& first, std::span<const uint64_t> inside,
                          const TileBricks& tile, const Column& out) {
  cell_ = &cell;
  first_ = first;
  inside_ = inside;
  out.field.resize(tile.voxels * out.count * sizeof(uint16_t));
  // Aligned, because a vector of bytes allocates as for any type.
  values_ = reinterpret_cast<uint16_t*>(out.field.data()) + out.n;
  stride_ = out.count;
  runs_.clear();
  for (const CellPoints::Run& run : cell.runs) {
    runs_.push_back({run.first, run.first[0] * kTileSide + run.first[1], Bits(0, run.count - 1)});
  }
  numbers_.fill(0);
  bricks_.clear();
  // New numbers of the field are 0. Most labels are nowhere in a tile, and then nothing is written.
  const bool any_inside = std::ranges::any_of(inside, [](uint64_t row) { return row != 0; });
  uint32_t voxels = 0;
  for (const Brick& brick : tile.bricks) {
    const Vec3i brick_at = brick.brick_ijk - tile.tile_ijk * kBrickSide;
    const Vec3i at = brick_at * kBrickSide;
    bricks_.push_back({&brick.mask, at, voxels, any_inside ? SetBrick(brick, at, voxels) : Side::kOutside});
    numbers_[static_cast<size_t>(brick_at[0] << 6 | brick_at[1] << 3 | brick_at[2])] =
        static_cast<uint16_t>(bricks_.size());
    voxels += static_cast<uint32_t>(CountVoxels(brick.mask));
  }
}

FractionTable::Side FractionTable::SetBrick(const Brick& brick, const Vec3i& at, uint32_t first) {
  const auto full = static_cast<uint16_t>(cell_->size());
  bool any_inside = false, any_outside = false;
  uint16_t* value = values_ + first * stride_;
  for (int32_t x = 0; x < kBrickSide; ++x) {
    for (uint64_t bits = brick.mask[static_cast<size_t>(x)]; bits != 0; bits &= bits - 1) {
      const int yz = std::countr_zero(bits);
      const auto row = static_cast<size_t>((at[0] + x) << kTileBits | (at[1] + (yz >> kBrickBits)));
      const bool is_inside = (inside_[row] >> (at[2] + (yz & (kBrickSide - 1))) & 1) != 0;
      any_inside |= is_inside;
      any_outside |= !is_inside;
      *value = is_inside ? full : 0;
      value += stride_;
    }
  }
  return any_inside && any_outside ? Side::kBoth : any_inside ? Side::kInside : Side::kOutside;
}

IndexBox FractionTable::Around() const {
  constexpr int32_t kLast = kTileSide - 1;
  return {first_ + cell_->low, first_ + Vec3i{kLast, kLast, kLast} * cell_->n + cell_->high + Vec3i{1, 1, 1}};
}

FractionTable::Range FractionTable::VoxelsNear(const Vec3i& low, int level) const {
  Range range;
  for (size_t m = 0; m < 3; ++m) {
    const int32_t from = low[m] - first_[m] - cell_->high[m];
    const int32_t to = low[m] + (kTileSide << level) - 1 - first_[m] - cell_->low[m];
    range.first[m] = std::max(CeilDiv(from, cell_->n), 0);
    range.last[m] = std::min(FloorDiv(to, cell_->n), kTileSide - 1);
  }
  return range;
}

// Calls f for the bricks with voxels in the range until it returns true. Returns whether it did.
template <class F>
bool FractionTable::AnyBrick(const Range& range, const F& f) const {
  const Vec3i first = Shifted(range.first, kBrickBits), last = Shifted(range.last, kBrickBits);
  for (int32_t i = first[0]; i <= last[0]; ++i) {
    for (int32_t j = first[1]; j <= last[1]; ++j) {
      for (int32_t k = first[2]; k <= last[2]; ++k) {
        const uint16_t number = numbers_[static_cast<size_t>(i << 6 | j << 3 | k)];
        if (number != 0 && f(bricks_[number - size_t{1}])) return true;
      }
    }
  }
  return false;
}

bool FractionTable::Meets(const Vec3i& low, int level) const {
  return AnyBrick(VoxelsNear(low, level), [](const PlacedBrick&) { return true; });
}

void FractionTable::Add(const Vec3i& low, std::span<const uint64_t> rows) {
  const FinerTile finer{first_ - low, VoxelsNear(low, 0), rows};
  AnyBrick(finer.near, [&](const PlacedBrick& brick) {
    if (!IsSettled({brick.at, kBrickSide}, brick.side, finer)) AddBrick(brick, finer);
    return false;
  });
}

// The side of all points of a cube, whether or not they are voxels.
FractionTable::Side FractionTable::SideOf(const Cube& cube) const {
  const uint64_t mask = Bits(cube.at[2], cube.at[2] + cube.side - 1);
  uint64_t any = 0, all = mask;
  for (int32_t i = cube.at[0]; i < cube.at[0] + cube.side; ++i) {
    for (int32_t j = cube.at[1]; j < cube.at[1] + cube.side; ++j) {
      const uint64_t row = inside_[static_cast<size_t>(i << kTileBits | j)] & mask;
      any |= row;
      all &= row;
    }
  }
  return any == 0 ? Side::kOutside : all == mask ? Side::kInside : Side::kBoth;
}

// Returns whether all points of the cube's cells in the finer tile are on the side of its voxels.
bool FractionTable::IsSettled(const Cube& cube, Side side, const FinerTile& finer) const {
  if (side == Side::kBoth) return false;
  const uint64_t flip = side == Side::kInside ? ~uint64_t{0} : 0;
  Vec3i first, last;
  for (size_t m = 0; m < 3; ++m) {
    const int32_t at = finer.base[m] + cube.at[m] * cell_->n;
    first[m] = std::max(at + cell_->low[m], 0);
    last[m] = std::min(at + (cube.side - 1) * cell_->n + cell_->high[m], kTileSide - 1);
    if (first[m] > last[m]) return true;
  }
  const uint64_t mask = Bits(first[2], last[2]);
  for (int32_t i = first[0]; i <= last[0]; ++i) {
    uint64_t others = 0;
    for (int32_t j = first[1]; j <= last[1]; ++j) others |= finer.rows[static_cast<size_t>(i << kTileBits | j)] ^ flip;
    if ((others & mask) != 0) return false;
  }
  return true;
}

void FractionTable::AddBrick(const PlacedBrick& brick, const FinerTile& finer) {
  uint16_t rank = 0;
  for (size_t x = 0; x < brick.mask->size(); ++x) {
    for (uint64_t bits = (*brick.mask)[x]; bits != 0; bits &= bits - 1) {
      ranks_[x << 6 | static_cast<size_t>(std::countr_zero(bits))] = rank++;
    }
  }
  AddCube(brick, {brick.at, kBrickSide}, finer);
}

// Where most points are voxels, it divides the cube and leaves out what is settled.
void FractionTable::AddCube(const PlacedBrick& brick, const Cube& cube, const FinerTile& finer) {
  constexpr int32_t kLeastSide = 2;
  const Vec3i in_brick = cube.at - brick.at;
  uint64_t part = 0;
  for (int32_t y = 0; y < cube.side; ++y) {
    part |= Bits(in_brick[2], in_brick[2] + cube.side - 1) << ((in_brick[1] + y) << kBrickBits);
  }
  const auto word = [&](int32_t x) { return (*brick.mask)[static_cast<size_t>(in_brick[0] + x)] & part; };
  int32_t count = 0;
  for (int32_t x = 0; x < cube.side; ++x) count += std::popcount(word(x));
  const bool is_dense = 2 * count > cube.side * cube.side * cube.side;
  if (is_dense && cube.side < kBrickSide && IsSettled(cube, SideOf(cube), finer)) return;
  if (is_dense && cube.side > kLeastSide) {
    const int32_t half = cube.side / 2;
    for (int32_t n = 0; n < 8; ++n) AddCube(brick, {cube.at + Vec3i{n >> 2, n >> 1 & 1, n & 1} * half, half}, finer);
    return;
  }
  for (int32_t x = 0; x < cube.side; ++x) {
    for (uint64_t bits = word(x); bits != 0; bits &= bits - 1) {
      const int yz = std::countr_zero(bits);
      const Vec3i z = brick.at + Vec3i{in_brick[0] + x, yz >> kBrickBits, yz & (kBrickSide - 1)};
      AddVoxel(z, finer, values_[(brick.first + ranks_[static_cast<size_t>((in_brick[0] + x) << 6 | yz)]) * stride_]);
    }
  }
}

void FractionTable::AddVoxel(const Vec3i& z, const FinerTile& finer, uint16_t& value) const {
  const Vec3i at = finer.base + z * cell_->n;
  bool is_near = true, is_whole = true;
  for (size_t m = 0; m < 3; ++m) {
    is_near &= finer.near.first[m] <= z[m] && z[m] <= finer.near.last[m];
    is_whole &= at[m] + cell_->low[m] >= 0 && at[m] + cell_->high[m] < kTileSide;
  }
  if (!is_near) return;
  const bool is_inside = (inside_[static_cast<size_t>(z[0] << kTileBits | z[1])] >> z[2] & 1) != 0;
  const uint64_t flip = is_inside ? ~uint64_t{0} : 0;
  const uint32_t others = is_whole ? CountWhole(at, finer.rows, flip) : CountPart(at, finer.rows, flip);
  value = static_cast<uint16_t>(is_inside ? value - others : value + others);
}

// Runs are so short that four of them fit one word.
uint32_t FractionTable::CountWhole(const Vec3i& at, std::span<const uint64_t> rows, uint64_t flip) const {
  static_assert(4 * kMostFraction <= 64);
  const uint64_t* const row = rows.data() + (at[0] * kTileSide + at[1]);
  const auto some = [&](const Run& run) { return (row[run.row] ^ flip) >> (at[2] + run.at[2]) & run.mask; };
  int count = 0;
  size_t n = 0;
  for (; n + 4 <= runs_.size(); n += 4) {
    count +=
        std::popcount(some(runs_[n]) | some(runs_[n + 1]) << 16 | some(runs_[n + 2]) << 32 | some(runs_[n + 3]) << 48);
  }
  for (; n < runs_.size(); ++n) count += std::popcount(some(runs_[n]));
  return static_cast<uint32_t>(count);
}

// The same for a cell that lies in the finer tile in part.
uint32_t FractionTable::CountPart(const Vec3i& at, std::span<const uint64_t> rows, uint64_t flip) const {
  int count = 0;
  for (const Run& run : runs_) {
    const Vec3i p = at + run.at;
    if (!IsInTile(p[0]) || !IsInTile(p[1]) || p[2] >= kTileSide || p[2] <= -kTileSide) continue;
    const uint64_t row = rows[static_cast<size_t>(p[0] << kTileBits | p[1])] ^ flip;
    count += std::popcount((p[2] >= 0 ? row >> p[2] : row << -p[2]) & run.mask);
  }
  return static_cast<uint32_t>(count);
}

}  // namespace latvox
