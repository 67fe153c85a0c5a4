// Guesses what a misspelled word means.
#ifndef LATVOX_MANUAL_NEAREST_WORD_H_
#define LATVOX_MANUAL_NEAREST_WORD_H_

#include <optional>
#include <string>
#include <vector>

#include "absl/strings/string_view.h"

namespace latvox {

// Returns the word with the fewest differing letters, the first such word, or nothing if all are unlike this one. Upper
// and lower case are the same letter, and so are '-' and '_'. A word that another one begins or ends with is like it.
std::optional<std::string> NearestWord(absl::string_view word, const std::vector<std::string>& words);

}  // namespace latvox

#endif  // LATVOX_MANUAL_NEAREST_WORD_H_
