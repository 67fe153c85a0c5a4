#include "core/walk/tile_rows.h"

#include <bit>
#include <cstring>

namespace latvox {

void ReadRows(const BitsLayout& layout, const TileBits& bits, const HaloBox& box, std::vector<WideRow>& rows) {
  static_assert(std::endian::native == std::endian::little, "words are read as bytes");
  const auto* const bytes = reinterpret_cast<const char*>(bits.words().data());
  const WideRow all = FirstBits(box.side[2]);
  rows.resize(box.rows());
  for (int32_t i = 0; i < box.side[0]; ++i) {
    for (int32_t j = 0; j < box.side[1]; ++j) {
      const uint32_t number = layout.NumberOf(box.low + Vec3i{i, j, 0});
      WideRow row;
      std::memcpy(&row, bytes + number / 8, sizeof(row));
      rows[box.RowOf(i, j)] = row >> number % 8 & all;
    }
  }
}

}  // namespace latvox
