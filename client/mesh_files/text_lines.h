// The lines and words of a text.
#ifndef LATVOX_CLIENT_MESH_FILES_TEXT_LINES_H_
#define LATVOX_CLIENT_MESH_FILES_TEXT_LINES_H_

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "absl/strings/match.h"
#include "absl/strings/string_view.h"

namespace latvox::client {

// Takes the next word off the front of `rest`. Returns "" at the end.
inline absl::string_view TakeWord(absl::string_view& rest) {
  // The first comparison decides on nearly all characters of words.
  const auto is_space = [](char c) {
    return static_cast<unsigned char>(c) <= ' ' && (c == ' ' || (c >= '\t' && c <= '\r'));
  };
  size_t begin = 0;
  while (begin < rest.size() && is_space(rest[begin])) ++begin;
  size_t end = begin;
  while (end < rest.size() && !is_space(rest[end])) ++end;
  const absl::string_view word = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return word;
}

// Reads lines that end in LF, CR LF, or CR alone.
class TextLines {
 public:
  explicit TextLines(absl::string_view text) : rest_(text), has_cr_(absl::StrContains(text, '\r')) {}

  // Returns false at the end.
  bool Next(absl::string_view& line) {
    if (rest_.empty()) return false;
    ++number_;
    const size_t end = has_cr_ ? std::min(rest_.find_first_of("\r\n"), rest_.size()) : FirstNewline();
    line = rest_.substr(0, end);
    rest_.remove_prefix(end);
    if (!rest_.empty()) rest_.remove_prefix(has_cr_ && absl::StartsWith(rest_, "\r\n") ? 2 : 1);
    return true;
  }

  // Returns the number of the last line, counted from 1.
  size_t number() const { return number_; }

  // Returns what follows the last line.
  absl::string_view rest() const { return rest_; }

 private:
  size_t FirstNewline() const {
    const void* const newline = std::memchr(rest_.data(), '\n', rest_.size());
    return newline == nullptr ? rest_.size() : static_cast<size_t>(static_cast<const char*>(newline) - rest_.data());
  }

  absl::string_view rest_;
  bool has_cr_;  // a text without any is read faster
  size_t number_ = 0;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_TEXT_LINES_H_
