#include "core/walk/packed_pieces.h"

#include <algorithm>
#include <array>

#include "core/brick/brick.h"

namespace latvox {
PackedPieces Pack(const HaloBox& box, const RowPieces& pieces) {
  PackedPieces packed;
  if (pieces.count() > UINT8_MAX) return packed;
  packed.reserve(size_t{8} << 10);
  size_t before = 0;  // the begin of the last row that did not repeat
  std::array<uint8_t, 1 + 3 * kTileSide> row;
  for (size_t n = 0; n < size_t{kTileSide} * kTileSide; ++n) {
    if (n % kTileSide != 0 && pieces.Repeats(box.RowOfTile(n))) {
      packed.push_back(0);
      continue;
    }
    size_t size = 1;
    for (const FreeRun& run : pieces.RunsOf(box.RowOfTile(n))) {
      const int32_t first = std::max(run.first - box.halo[2], 0),
                    last = std::min(run.last - box.halo[2], kTileSide - 1);
      if (first > last) continue;
      row[size++] = static_cast<uint8_t>(first);
      row[size++] = static_cast<uint8_t>(last);
      row[size++] = static_cast<uint8_t>(run.piece);
    }
    row[0] = static_cast<uint8_t>(1 + size / 3);
    const bool repeats = n > 0 && packed.size() >= before + size &&
                         std::equal(row.begin(), row.begin() + static_cast<ptrdiff_t>(size),
                                    packed.begin() + static_cast<ptrdiff_t>(before));
    if (repeats) {
      packed.push_back(0);
    } else {
      before = packed.size();
      packed.insert(packed.end(), row.begin(), row.begin() + static_cast<ptrdiff_t>(size));
    }
  }
  packed.shrink_to_fit();
  return packed;
}

void Unpack(const PackedPieces& packed, const std::function<bool(uint32_t piece)>& is_wanted, TileRows& rows) {
  std::array<bool, UINT8_MAX + 1> wanted{};
  for (uint32_t piece = 0; piece < wanted.size(); ++piece) wanted[piece] = is_wanted(piece);
  const uint8_t* at = packed.data();
  for (size_t n = 0; n < rows.size(); ++n) {
    const uint8_t runs = *at++;
    if (runs == 0) {
      rows[n] = rows[n - 1];
      continue;
    }
    rows[n] = 0;
    for (uint8_t run = 1; run < runs; ++run, at += 3) {
      if (wanted[at[2]]) rows[n] |= ~uint64_t{0} >> (kTileSide - 1 - at[1] + at[0]) << at[0];
    }
  }
}

}  // namespace latvox
