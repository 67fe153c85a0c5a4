#include "client/internal/trace_context.h"

#include <algorithm>

#include "absl/strings/ascii.h"

namespace latvox::client {
namespace {

// Upper case is malformed.
bool IsHex(absl::string_view text) { return text.find_first_not_of("0123456789abcdef") == absl::string_view::npos; }

bool IsId(absl::string_view text) { return IsHex(text) && text.find_first_not_of('0') != absl::string_view::npos; }

bool IsVisible(absl::string_view text) {
  return std::all_of(text.begin(), text.end(),
                     [](char c) { return absl::ascii_isprint(static_cast<unsigned char>(c)); });
}

}  // namespace

// version "-" trace-id "-" parent-id "-" flags: 2, 32, 16 and 2 digits. Later versions may go on after another "-".
bool IsTraceparent(absl::string_view value) {
  constexpr size_t kSize = 55;
  if (value.size() < kSize || value[2] != '-' || value[35] != '-' || value[52] != '-') return false;
  const absl::string_view version = value.substr(0, 2), more = value.substr(kSize);
  return IsHex(version) && version != "ff" && IsId(value.substr(3, 32)) && IsId(value.substr(36, 16)) &&
         IsHex(value.substr(53, 2)) && (more.empty() || (version != "00" && more[0] == '-' && IsVisible(more)));
}

bool IsTracestate(absl::string_view value) {
  constexpr size_t kMaxSize = 512;  // W3C: everyone should pass on at least this much
  return !value.empty() && value.size() <= kMaxSize && IsVisible(value);
}

}  // namespace latvox::client
