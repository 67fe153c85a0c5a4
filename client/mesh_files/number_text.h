// Decimal text to numbers.
#ifndef LATVOX_CLIENT_MESH_FILES_NUMBER_TEXT_H_
#define LATVOX_CLIENT_MESH_FILES_NUMBER_TEXT_H_

#include <charconv>
#include <cstdlib>
#include <limits>
#include <string>
#include <system_error>

#include "absl/strings/string_view.h"

namespace latvox::client {

// Reads the whole `word` as the nearest double, infinite if it is too large. Returns false if it is not a number.
// "1.#IND" and the like, which old C libraries write, are NaN.
inline bool ParseDouble(absl::string_view word, double& value) {
  if (word.find(".#") != absl::string_view::npos) {
    value = std::numeric_limits<double>::quiet_NaN();
    return true;
  }
  if (!word.empty() && word[0] == '+') word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size()) return false;
  // from_chars returns no value on overflow and underflow; strtod returns the right one.
  if (error == std::errc::result_out_of_range) value = std::strtod(std::string(word).c_str(), nullptr);
  return error == std::errc() || error == std::errc::result_out_of_range;
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_NUMBER_TEXT_H_
