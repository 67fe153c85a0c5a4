// The pieces of a tile's points, packed, so that a delivered tile need not find them again.
#ifndef LATVOX_CORE_WALK_PACKED_PIECES_H_
#define LATVOX_CORE_WALK_PACKED_PIECES_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/walk/row_pieces.h"
#include "core/walk/tile_rows.h"

namespace latvox {

// All packed pieces of a job together. Tiles beyond that find theirs again.
inline constexpr size_t kMostPackedBytes = size_t{64} << 20;

// For each row of the tile: 0 if it repeats the row before it; otherwise 1 + the number of its runs, and for each run
// its first and last bit and its piece. Empty if a number does not fit a byte.
using PackedPieces = std::vector<uint8_t>;
PackedPieces Pack(const HaloBox& box, const RowPieces& pieces);

// Finds the points of all pieces with is_wanted(piece).
void Unpack(const PackedPieces& packed, const std::function<bool(uint32_t piece)>& is_wanted, TileRows& rows);

}  // namespace latvox

#endif  // LATVOX_CORE_WALK_PACKED_PIECES_H_
