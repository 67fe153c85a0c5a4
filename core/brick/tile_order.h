// The canonical order of tiles: Morton order of their coordinates relative to the lowest tile of the whole mesh's box,
// i the most significant axis.
#ifndef LATVOX_CORE_BRICK_TILE_ORDER_H_
#define LATVOX_CORE_BRICK_TILE_ORDER_H_

#include <cstdint>
#include <limits>

#include "core/base/vec.h"

namespace latvox {

// Returns the tile's place in the order, from 0: the bits of its relative coordinates in turn. A cube of 2^L tiles a
// side, with a corner that is a multiple of that, has the 8^L numbers from its corner's on. Precondition: 0 <= each
// coordinate < 2^21.
constexpr uint64_t TileNumber(const Vec3i& relative) {
  const auto spread = [](int32_t coordinate) {
    auto x = static_cast<uint64_t>(coordinate);
    x = (x | x << 32) & 0x001f'0000'0000'ffff;
    x = (x | x << 16) & 0x001f'0000'ff00'00ff;
    x = (x | x << 8) & 0x100f'00f0'0f00'f00f;
    x = (x | x << 4) & 0x10c3'0c30'c30c'30c3;
    return (x | x << 2) & 0x1249'2492'4924'9249;
  };
  return spread(relative[0]) << 2 | spread(relative[1]) << 1 | spread(relative[2]);
}

// The tiles with these numbers.
struct TileSpan {
  uint64_t begin = 0, end = std::numeric_limits<uint64_t>::max();

  bool Contains(uint64_t number) const { return begin <= number && number < end; }
  // Returns whether any of `count` numbers from `first` on is in the span.
  bool Meets(uint64_t first, uint64_t count) const { return first < end && begin < first + count; }
  bool operator==(const TileSpan&) const = default;
};

}  // namespace latvox

#endif  // LATVOX_CORE_BRICK_TILE_ORDER_H_
