#include "client/mesh_files/utf16.h"

#include <cstdint>

namespace latvox::client {
namespace {

void AppendUtf8(uint32_t code, std::string& out) {
  const auto tail = [code](int shift) { return static_cast<char>(0x80 | (code >> shift & 0x3F)); };
  if (code < 0x80) {
    out += static_cast<char>(code);
  } else if (code < 0x800) {
    out += {static_cast<char>(0xC0 | code >> 6), tail(0)};
  } else if (code < 0x10000) {
    out += {static_cast<char>(0xE0 | code >> 12), tail(6), tail(0)};
  } else {
    out += {static_cast<char>(0xF0 | code >> 18), tail(12), tail(6), tail(0)};
  }
}

}  // namespace

std::string Utf8OfUtf16(absl::string_view units, bool big_endian) {
  constexpr uint32_t kReplacement = 0xFFFD;
  const auto unit = [&](size_t n) -> uint32_t {
    const auto a = static_cast<uint8_t>(units[n]), b = static_cast<uint8_t>(units[n + 1]);
    return big_endian ? uint32_t{a} << 8 | b : uint32_t{b} << 8 | a;
  };
  std::string out;
  out.reserve(units.size() / 2);
  for (size_t n = 0; n < units.size(); n += 2) {
    uint32_t code = n + 1 < units.size() ? unit(n) : kReplacement;
    if (code >= 0xD800 && code < 0xE000) {
      const uint32_t low = code < 0xDC00 && n + 3 < units.size() ? unit(n + 2) : 0;
      const bool is_pair = low >= 0xDC00 && low < 0xE000;
      code = is_pair ? 0x10000 + ((code - 0xD800) << 10 | (low - 0xDC00)) : kReplacement;
      if (is_pair) n += 2;
    }
    AppendUtf8(code, out);
  }
  return out;
}

}  // namespace latvox::client
