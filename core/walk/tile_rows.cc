#include "core/walk/tile_rows.h"

#include <bit>
#include <cstddef>
#include <cstring>

namespace latvox {

void ReadRows(const BitsLayout& layout, const TileBits& bits, const HaloBox& box, std::vector<WideRow>& rows) {
  static_assert(std::endian::native == std::endian::little, "words are read as bytes");
  const auto* const bytes = reinterpret_cast<const char*>(bits.words().data());
  const WideRow all = FirstBits(box.side[2]);
  const uint32_t first = layout.NumberOf(box.low);
  const uint32_t shift = first % 8;  // of all rows: strides are whole bytes
  rows.resize(box.rows());
  auto out = rows.begin();
  for (int32_t i = 0; i < box.side[0]; ++i) {
    const char* at = bytes + first / 8 + static_cast<ptrdiff_t>(i) * (layout.stride[0] / 8);
    for (int32_t j = 0; j < box.side[1]; ++j, at += layout.stride[1] / 8) {
      WideRow row;
      std::memcpy(&row, at, sizeof(row));
      *out++ = row >> shift & all;
    }
  }
}

}  // namespace latvox
