// Decimal text to float32.
#ifndef LATVOX_CLIENT_TOOL_MESH_FILES_FLOAT_TEXT_H_
#define LATVOX_CLIENT_TOOL_MESH_FILES_FLOAT_TEXT_H_

#include <charconv>
#include <cstdlib>
#include <string>
#include <system_error>

#include "absl/strings/string_view.h"

namespace latvox::client {

// The nearest float32 to the whole of `word`, infinite if it is too large; false if that is not a number.
inline bool ParseFloat(absl::string_view word, float& value) {
  if (!word.empty() && word[0] == '+') word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size()) return false;
  // from_chars has no value for what overflows or underflows; strtof has the right one for both.
  if (error == std::errc::result_out_of_range) value = std::strtof(std::string(word).c_str(), nullptr);
  return error == std::errc() || error == std::errc::result_out_of_range;
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_MESH_FILES_FLOAT_TEXT_H_
