// Reads numbers at the front of text.
#ifndef LATVOX_CLIENT_TOOL_CURVE_SCAN_H_
#define LATVOX_CLIENT_TOOL_CURVE_SCAN_H_

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <string>

#include "absl/strings/ascii.h"
#include "absl/strings/string_view.h"

namespace latvox::client {

inline void SkipSpace(absl::string_view& rest) {
  while (!rest.empty() && absl::ascii_isspace(static_cast<unsigned char>(rest[0]))) rest.remove_prefix(1);
}

// Skips white space with at most one comma.
inline void SkipSeparator(absl::string_view& rest) {
  SkipSpace(rest);
  if (rest.empty() || rest[0] != ',') return;
  rest.remove_prefix(1);
  SkipSpace(rest);
}

// Reads the longest decimal number at the front of `rest`, as the nearest double. Returns false and leaves `rest`
// unchanged if there is none, or if it is not finite as a double.
inline bool ReadDecimal(absl::string_view& rest, double& number) {
  absl::string_view text = rest;
  if (!text.empty() && text[0] == '+') text.remove_prefix(1);
  const size_t first = text.size() > 1 && text[0] == '-' && text.size() == rest.size() ? 1 : 0;
  // from_chars also reads "inf" and "nan".
  if (text.size() <= first || !(absl::ascii_isdigit(static_cast<unsigned char>(text[first])) || text[first] == '.')) {
    return false;
  }
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error == std::errc::invalid_argument) return false;
  // from_chars returns no value on overflow and underflow; strtod returns the right one.
  if (error == std::errc::result_out_of_range) number = std::strtod(std::string(text.data(), end).c_str(), nullptr);
  if (!std::isfinite(number)) return false;
  rest.remove_prefix(static_cast<size_t>(end - rest.data()));
  return true;
}

// Returns the beginning of `rest` for messages: up to white space or 20 characters.
inline std::string Shown(absl::string_view rest) {
  constexpr size_t kMost = 20;
  size_t end = 0;
  while (end < rest.size() && end < kMost && !absl::ascii_isspace(static_cast<unsigned char>(rest[end]))) ++end;
  return std::string{rest.substr(0, end)};
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CURVE_SCAN_H_
