#include "core/walk/packed_pieces.h"

#include <algorithm>
#include <array>
#include <span>

#include "core/brick/brick.h"

namespace latvox {
namespace {

constexpr size_t kMostOfRow = 1 + 3 * size_t{kTileSide};

// Writes a row as PackedPieces has it, and returns its size.
size_t PackRow(std::span<const FreeRun> runs, int32_t halo, uint8_t* out) {
  size_t size = 1;
  for (const FreeRun& run : runs) {
    const int32_t first = std::max(run.first - halo, 0), last = std::min(run.last - halo, kTileSide - 1);
    if (first > last) continue;
    out[size] = static_cast<uint8_t>(first);
    out[size + 1] = static_cast<uint8_t>(last);
    out[size + 2] = static_cast<uint8_t>(run.piece);
    size += 3;
  }
  out[0] = static_cast<uint8_t>(1 + size / 3);
  return size;
}

}  // namespace

// Plane by plane. Each plane's first row is packed in full.
PackedPieces Pack(const HaloBox& box, const RowPieces& pieces) {
  PackedPieces packed;
  if (pieces.count() > UINT8_MAX) return packed;
  packed.reserve(size_t{8} << 10);
  std::array<uint8_t, kMostOfRow * kTileSide> plane;
  for (size_t i = 0; i < kTileSide; ++i) {
    const size_t first = box.RowOfTile(i * kTileSide);
    const uint8_t* const repeats = &pieces.repeats()[first];
    uint8_t *end = plane.data(), *before = end;  // before: the last row that did not repeat
    size_t size_before = 0;
    for (size_t j = 0; j < kTileSide; ++j) {
      if (j != 0 && repeats[j] != 0) {
        *end++ = 0;
        continue;
      }
      const size_t size = PackRow(pieces.RunsOf(first + j), box.halo[2], end);
      if (size == size_before && std::equal(end, end + size, before)) {
        *end++ = 0;
        continue;
      }
      before = end;
      size_before = size;
      end += size;
    }
    packed.insert(packed.end(), plane.data(), end);
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
