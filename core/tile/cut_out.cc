// Eight rows of the tile, one byte a brick, become one word of each of eight bricks: a transposed 8x8 matrix of bytes.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/tile/cut_out.cc"
#include "core/tile/cut_out.h"

#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <vector>

namespace latvox {
#ifndef LATVOX_CORE_TILE_CUT_OUT_CC_ONCE
#define LATVOX_CORE_TILE_CUT_OUT_CC_ONCE
namespace {

constexpr int32_t kBricks = kTileSide / kBrickSide;  // along a side

// The words of the bricks in one column along k: [x][brick].
using Column = std::array<std::array<uint64_t, kBricks>, kBrickSide>;

// rows: where row (x, y) = (0, 0) begins, and the bytes from one x to the next, from one y to the next. Returns which
// bricks have any voxel, bit n for brick n; if none has, `column` is meaningless.
uint32_t ScalarColumn(const uint8_t* rows, size_t step_x, size_t step_y, Column& column) {
  uint64_t any = 0;
  for (size_t x = 0; x < kBrickSide; ++x) {
    column[x] = {};
    for (size_t y = 0; y < kBrickSide; ++y) {
      for (size_t n = 0; n < kBricks; ++n) {
        const uint64_t byte = rows[x * step_x + y * step_y + n];
        column[x][n] |= byte << (8 * y);
        any |= uint64_t{byte != 0} << n;
      }
    }
  }
  return static_cast<uint32_t>(any);
}

}  // namespace
#endif
}  // namespace latvox

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// The bitwise or of eight planes, byte by byte.
//   bytes   of a plane: at least a vector's
void OrPlanes(const uint8_t* plane, size_t step_x, size_t bytes, uint8_t* any) {
  const hn::ScalableTag<uint8_t> d;
  constexpr size_t kLanes = HWY_LANES(uint8_t);
  static_assert(kLanes <= kBrickSide * kBricks, "no more than a column's rows have");
  for (size_t n = 0; n < bytes; n += kLanes) {
    const size_t at = std::min(n, bytes - kLanes);
    auto some = hn::LoadU(d, plane + at);
    for (size_t x = 1; x < kBrickSide; ++x) some = hn::Or(some, hn::LoadU(d, plane + x * step_x + at));
    hn::StoreU(some, d, any + at);
  }
}

// The bitwise or of eight rows.
uint64_t OrRows(const uint8_t* row, size_t step_y) {
  uint64_t any = 0;
  for (size_t y = 0; y < kBrickSide; ++y) {
    uint64_t bytes;
    std::memcpy(&bytes, row + y * step_y, sizeof(bytes));
    any |= bytes;
  }
  return any;
}

#if HWY_TARGET == HWY_SCALAR
uint32_t CutColumn(const uint8_t* rows, size_t step_x, size_t step_y, uint64_t, Column& column) {
  return ScalarColumn(rows, step_x, step_y, column);
}
#else
//   any   OrRows of all its rows
uint32_t CutColumn(const uint8_t* rows, size_t step_x, size_t step_y, uint64_t any, Column& column) {
  const hn::FixedTag<uint8_t, 16> d;
  const hn::Repartition<uint16_t, decltype(d)> d16;
  const hn::Repartition<uint32_t, decltype(d)> d32;
  const hn::Repartition<uint64_t, decltype(d)> d64;
  const hn::FixedTag<uint8_t, 8> half;
  for (size_t x = 0; x < kBrickSide; ++x, rows += step_x) {
    const auto row = [&](size_t y) HWY_ATTR { return hn::ZeroExtendVector(d, hn::LoadU(half, rows + y * step_y)); };
    const auto r01 = hn::BitCast(d16, hn::InterleaveLower(row(0), row(1)));
    const auto r23 = hn::BitCast(d16, hn::InterleaveLower(row(2), row(3)));
    const auto r45 = hn::BitCast(d16, hn::InterleaveLower(row(4), row(5)));
    const auto r67 = hn::BitCast(d16, hn::InterleaveLower(row(6), row(7)));
    const auto a0 = hn::BitCast(d32, hn::InterleaveLower(d16, r01, r23));  // rows 0..3, bytes 0..3
    const auto a1 = hn::BitCast(d32, hn::InterleaveUpper(d16, r01, r23));  // bytes 4..7
    const auto b0 = hn::BitCast(d32, hn::InterleaveLower(d16, r45, r67));
    const auto b1 = hn::BitCast(d32, hn::InterleaveUpper(d16, r45, r67));
    uint64_t* words = column[x].data();
    hn::StoreU(hn::BitCast(d64, hn::InterleaveLower(d32, a0, b0)), d64, words);
    hn::StoreU(hn::BitCast(d64, hn::InterleaveUpper(d32, a0, b0)), d64, words + 2);
    hn::StoreU(hn::BitCast(d64, hn::InterleaveLower(d32, a1, b1)), d64, words + 4);
    hn::StoreU(hn::BitCast(d64, hn::InterleaveUpper(d32, a1, b1)), d64, words + 6);
  }
  uint64_t bricks = 0;
  const auto bytes = hn::BitCast(half, hn::Set(hn::Repartition<uint64_t, decltype(half)>(), any));
  hn::StoreMaskBits(half, hn::Ne(bytes, hn::Zero(half)), reinterpret_cast<uint8_t*>(&bricks));
  return static_cast<uint32_t>(bricks);
}

#endif

TileBricks CutTile(bool plain, const BitsLayout& layout, const TileBits& bits, const Vec3i& tile_min,
                   const IndexBox& region, const Vec3i& base_ijk) {
  const auto* bytes = reinterpret_cast<const uint8_t*>(bits.words().data());
  TileBricks out;
  for (size_t m = 0; m < 3; ++m) out.tile_ijk[m] = (tile_min[m] + base_ijk[m]) >> kTileBits;
  // On the stack first, so that the list is allocated once, and no larger than necessary.
  std::array<Brick, kBricks * kBricks * kBricks> found;
  size_t size = 0;
  Column column;
  Vec3i first, end;  // bricks of the tile that meet the region
  for (size_t m = 0; m < 3; ++m) {
    first[m] = std::max((region.min[m] - tile_min[m]) >> kBrickBits, 0);
    end[m] = std::min(((region.max[m] - tile_min[m] - 1) >> kBrickBits) + 1, kBricks);
    if (first[m] >= end[m]) return out;
  }
  const auto step_x = static_cast<size_t>(layout.stride[0] / 8), step_y = static_cast<size_t>(layout.stride[1] / 8);
  std::vector<uint8_t> any(static_cast<size_t>((end[1] - first[1]) * kBrickSide) * step_y);
  for (int32_t bi = first[0]; bi < end[0]; ++bi) {
    const uint8_t* rows = bytes + layout.NumberOf(tile_min + Vec3i{bi, first[1], 0} * kBrickSide) / 8;
    // Many columns have no voxels; it is cheaper to find them together, plane by plane.
    if (!plain) OrPlanes(rows, step_x, any.size() - (step_y - kBricks), any.data());
    for (int32_t bj = first[1]; bj < end[1]; ++bj, rows += kBrickSide * step_y) {
      const Vec3i corner = tile_min + Vec3i{bi, bj, 0} * kBrickSide;
      uint32_t bricks = 0;
      if (plain) {
        bricks = ScalarColumn(rows, step_x, step_y, column);
      } else {
        const uint64_t in_column = OrRows(&any[static_cast<size_t>((bj - first[1]) * kBrickSide) * step_y], step_y);
        if (in_column == 0) continue;
        bricks = CutColumn(rows, step_x, step_y, in_column, column);
      }
      for (uint32_t some = bricks; some != 0; some &= some - 1) {
        const auto n = static_cast<size_t>(std::countr_zero(some));
        Brick& brick = found[size];
        brick.brick_ijk = corner;
        brick.brick_ijk[2] += static_cast<int32_t>(n) * kBrickSide;
        for (int32_t& x : brick.brick_ijk) x >>= kBrickBits;
        for (size_t x = 0; x < kBrickSide; ++x) brick.mask[x] = column[x][n];
        ClipBrick(region, brick);
        const uint64_t voxels = CountVoxels(brick.mask);
        if (voxels == 0) continue;
        for (size_t m = 0; m < 3; ++m) brick.brick_ijk[m] += base_ijk[m] >> kBrickBits;
        out.voxels += voxels;
        ++size;
      }
    }
  }
  out.bricks.assign(found.begin(), found.begin() + static_cast<ptrdiff_t>(size));
  return out;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "core/base/simd.h"

namespace latvox {
namespace {

HWY_EXPORT(CutTile);

}  // namespace

TileBricks CutOut(const BitsLayout& layout, const TileBits& bits, const Vec3i& tile_min, const IndexBox& region,
                  const Vec3i& base_ijk) {
  return HWY_DYNAMIC_DISPATCH(CutTile)(SimdIsScalar(), layout, bits, tile_min, region, base_ijk);
}

}  // namespace latvox
#endif  // HWY_ONCE
