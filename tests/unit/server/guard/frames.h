// Bytes of HTTP/2 for tests of the guard.
#ifndef LATVOX_TESTS_UNIT_SERVER_GUARD_FRAMES_H_
#define LATVOX_TESTS_UNIT_SERVER_GUARD_FRAMES_H_

#include <cstdint>
#include <string>

namespace latvox::http2 {

inline constexpr uint8_t kData = 0, kHeaders = 1, kReset = 3, kSettings = 4, kPing = 6, kWindowUpdate = 8,
                         kContinuation = 9;
inline constexpr uint8_t kAcknowledged = 1, kEndHeaders = 4, kPadded = 8, kPriority = 32;

inline std::string BigEndian(uint32_t value, int bytes) {
  std::string text;
  for (int n = bytes - 1; n >= 0; --n) text.push_back(static_cast<char>(uint64_t{value} >> (8 * n)));
  return text;
}

inline std::string Frame(uint8_t type, uint8_t flags, uint32_t stream, const std::string& payload) {
  return BigEndian(static_cast<uint32_t>(payload.size()), 3) + BigEndian(type, 1) + BigEndian(flags, 1) +
         BigEndian(stream, 4) + payload;
}

inline std::string Preface() { return "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + Frame(kSettings, 0, 0, ""); }
inline std::string Acknowledgment() { return Frame(kSettings, kAcknowledged, 0, ""); }

// An integer with a prefix of seven bits, by RFC 7541.
inline std::string Integer(uint32_t value) {
  if (value < 127) return BigEndian(value, 1);
  std::string text = "\x7f";
  for (value -= 127; value >= 128; value >>= 7) text += BigEndian((value & 127) | 128, 1);
  return text + BigEndian(value, 1);
}

// A field that does not enter the table; with `first` = "\x40" it does.
inline std::string Field(const std::string& name, const std::string& value, const std::string& first = {'\0'}) {
  return first + Integer(static_cast<uint32_t>(name.size())) + name + Integer(static_cast<uint32_t>(value.size())) +
         value;
}

inline std::string Call(uint32_t stream) {
  return Frame(kHeaders, kEndHeaders, stream, Field(":method", "POST") + Field(":path", "/x"));
}

}  // namespace latvox::http2

#endif  // LATVOX_TESTS_UNIT_SERVER_GUARD_FRAMES_H_
