// The options of a program or command, as the rows of a table.
#ifndef LATVOX_MANUAL_OPTION_ROW_H_
#define LATVOX_MANUAL_OPTION_ROW_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace latvox {

// Words that are wrong, by themselves or together. The text is for people, and names the option.
class UsageError : public std::runtime_error {
 public:
  explicit UsageError(const std::string& text, bool of_unknown_word = false)
      : std::runtime_error(text), is_unknown_word(of_unknown_word) {}

  const bool is_unknown_word;
};

// What parsing writes; it must outlive the parser.
//   bool                  a flag; "--minimal,!--no-minimal" has its contrary, too
//   optional<bool>        a flag that also tells whether it was given
//   vector<string>        takes several words
//   function              is called with each word
using OptionTarget =
    std::variant<bool*, std::optional<bool>*, int*, uint32_t*, uint64_t*, std::optional<int>*, std::optional<double>*,
                 std::string*, std::vector<std::string>*, std::function<void(const std::string&)>>;

struct OptionCheck {
  std::function<std::string(const std::string&)> wrong;  // what is wrong with a word, without the option's name; or ""
  std::string name = {};                                 // for help; or ""
};

struct OptionRow {
  std::string names;  // "-o,--out"; of a positional one its name alone
  OptionTarget target;
  std::string help;
  std::string value = {};                // what stands for its value in help: "FILE", "N"; empty: the target's type
  std::string group = {};                // in help and manual; empty: that of the row before
  std::vector<std::string> words = {};   // it must be one of these; empty: any
  std::vector<OptionCheck> checks = {};  // in this order, on each word
  bool is_size = false;                  // "1GiB" is a number, too; the first check looks at the word before
  bool required = false;
  bool one_each_time = false;    // may be given again and again, with one word each time
  char delimiter = 0;            // between several words in one
  std::string environment = {};  // variable that is read if the option is not given
  std::string standard = {};     // what it is if it is not given, for help
  bool in_file = true;           // may stand in the configuration file
};

// Two options of which the first excludes the other, or needs it.
using OptionPairs = std::vector<std::pair<std::string, std::string>>;

}  // namespace latvox

#endif  // LATVOX_MANUAL_OPTION_ROW_H_
