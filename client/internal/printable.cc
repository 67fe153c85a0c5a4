#include "client/internal/printable.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"

namespace latvox::client {
namespace {

// Returns the length of the UTF-8 character at the start of the text; 0 for a control character or another byte. The
// ranges are those of table 3-7 of the Unicode Standard, without the controls U+0080 to U+009F.
size_t CharacterLength(absl::string_view text) {
  const auto byte = [&](size_t n) { return n < text.size() ? static_cast<uint8_t>(text[n]) : uint8_t{0}; };
  const auto within = [&](size_t n, uint8_t least, uint8_t most) { return least <= byte(n) && byte(n) <= most; };
  const auto continues = [&](size_t n) { return within(n, 0x80, 0xBF); };
  const uint8_t first = byte(0);
  if (within(0, 0x20, 0x7E)) return 1;
  if (first == 0xC2) return within(1, 0xA0, 0xBF) ? 2 : 0;
  if (within(0, 0xC3, 0xDF)) return continues(1) ? 2 : 0;
  if (within(0, 0xE0, 0xEF)) {
    const bool second = within(1, first == 0xE0 ? 0xA0 : 0x80, first == 0xED ? 0x9F : 0xBF);
    return second && continues(2) ? 3 : 0;
  }
  if (within(0, 0xF0, 0xF4)) {
    const bool second = within(1, first == 0xF0 ? 0x90 : 0x80, first == 0xF4 ? 0x8F : 0xBF);
    return second && continues(2) && continues(3) ? 4 : 0;
  }
  return 0;
}

}  // namespace

std::string Printable(absl::string_view text) {
  std::string out;
  while (!text.empty()) {
    const size_t length = CharacterLength(text);
    absl::StrAppend(&out, length == 0 ? absl::CHexEscape(text.substr(0, 1)) : text.substr(0, length));
    text.remove_prefix(std::max<size_t>(length, 1));
  }
  return out;
}

std::string ValidUtf8(absl::string_view text) {
  std::string out;
  while (!text.empty()) {
    const auto byte = [&](size_t n) { return n < text.size() ? static_cast<uint8_t>(text[n]) : uint8_t{0}; };
    size_t length = CharacterLength(text);
    if (byte(0) < 0x80) length = 1;                                         // controls are characters here
    if (byte(0) == 0xC2 && byte(1) >= 0x80 && byte(1) <= 0x9F) length = 2;  // and so are U+0080 to U+009F
    absl::StrAppend(&out, length == 0 ? "\xEF\xBF\xBD" : text.substr(0, length));
    text.remove_prefix(std::max<size_t>(length, 1));
  }
  return out;
}

absl::Status PrintableStatus(const absl::Status& status) {
  absl::Status out(status.code(), Printable(status.message()));
  status.ForEachPayload([&out](absl::string_view type, const absl::Cord& text) { out.SetPayload(type, text); });
  return out;
}

}  // namespace latvox::client
