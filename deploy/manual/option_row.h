// The options of a program or command, as rows of a table.
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

// The fault in a command line, for programs. Empty texts are unknown.
struct UsageDetails {
  std::string option = {};  // "--resolution"
  std::string value = {};   // as given
  std::string limit = {};   // of values: "2 to 65536"
  std::string other = {};   // the option that excludes this one
};

// An error in the words of a command line. The text is for people and names the option.
class UsageError : public std::runtime_error {
 public:
  explicit UsageError(const std::string& text, UsageDetails details = {})
      : std::runtime_error(text), details_(std::move(details)) {}
  const UsageDetails& details() const { return details_; }

 private:
  UsageDetails details_;
};

// The error of a word.
struct WrongWord {
  // NOLINTBEGIN(google-explicit-constructor): most checks return the text alone
  WrongWord(const char* what) : text(what) {}
  WrongWord(std::string what, std::string word = {}, std::string range = {})
      : text(std::move(what)), value(std::move(word)), limit(std::move(range)) {}
  // NOLINTEND(google-explicit-constructor)

  std::string text;   // without the option's name; empty: the word is right
  std::string value;  // empty: the word
  std::string limit;  // empty: OptionCheck::range
};

// Receives the parsed value. It must outlive the parser.
//   bool                  a flag; "--minimal,!--no-minimal" defines its negation as well
//   optional<bool>        a flag, empty unless it was given
//   vector<string>        takes several words
//   function              is called with each word
using OptionTarget =
    std::variant<bool*, std::optional<bool>*, int*, uint32_t*, uint64_t*, std::optional<int>*, std::optional<double>*,
                 std::string*, std::vector<std::string>*, std::function<void(const std::string&)>>;

struct OptionCheck {
  std::function<WrongWord(const std::string&)> wrong;
  std::string range = {};  // of values, for help: "2 to 65536"; or ""
};

struct OptionRow {
  std::string names;         // "-o,--out"; a positional option has one name without dashes
  std::string aliases = {};  // further names that are accepted but not shown: "--output"
  OptionTarget target;
  std::string help;
  std::string value = {};                   // the name of its value in help: "FILE"; empty: from `words` or the target
  std::string group = {};                   // heading in help and manual; empty: that of the previous row
  std::vector<std::string> words = {};      // accepted words, in upper or lower case; empty: any
  std::vector<std::string> word_help = {};  // of each of `words`, in their order, for completions
  std::vector<OptionCheck> checks = {};     // applied to each word in this order
  bool is_size = false;                     // accepts "1GiB" as well; the first check sees the word as given
  bool is_number = false;                   // the words of a function are numbers
  uint64_t most = 0;                        // largest value of a whole number; 0: that of the target
  bool required = false;
  bool one_each_time = false;    // may be repeated, with one word each time
  char delimiter = 0;            // separates several values in one word
  std::string environment = {};  // variable that sets the option if the command line does not
  std::string standard = {};     // default value, for help
  bool in_file = true;           // may stand in the configuration file
};

// Pairs of options: the first excludes the second, or needs it.
using OptionPairs = std::vector<std::pair<std::string, std::string>>;

}  // namespace latvox

#endif  // LATVOX_MANUAL_OPTION_ROW_H_
