// Reads command lines by tables of options. Only its .cc sees the library that does it, CLI11.
#ifndef LATVOX_MANUAL_COMMAND_PARSER_H_
#define LATVOX_MANUAL_COMMAND_PARSER_H_

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "deploy/manual/command_facts.h"
#include "deploy/manual/option_row.h"

namespace latvox {

// An option after parsing.
struct OptionState {
  enum class Source { kDefault, kFlag, kEnvironment, kFile };
  std::string name;                 // without dashes
  std::vector<std::string> values;  // as they were given, or by default
  bool is_list = false;             // takes several
  Source source = Source::kDefault;
  std::string environment;  // variable that sets it
};

// A program, or one of its commands. Not thread-safe.
class CommandParser {
 public:
  explicit CommandParser(const std::string& description = "", const std::string& name = "");
  ~CommandParser();
  CommandParser(const CommandParser&) = delete;
  CommandParser& operator=(const CommandParser&) = delete;

  // All before Parse.
  void Add(const std::vector<OptionRow>& rows);
  void Exclude(const OptionPairs& pairs);  // of options that were added
  void Need(const OptionPairs& pairs);     // of options that were added
  void SetFooter(const std::string& text);
  // Adds --version, which tells this.
  void SetVersion(const std::string& text);
  // Adds an option for a configuration file, TOML with the options' long names as keys.
  //   path       of the file unless the option names another, which must exist; empty: none
  //   is_above   whether something wins over the file in an option of this name, without dashes
  void ReadFile(const std::string& option, const std::string& path, const std::string& help,
                std::function<bool(const std::string& name)> is_above);
  // The command belongs to this program, at most one of which is given.
  CommandParser& AddCommand(const std::string& name, const std::string& description);

  // Reads the words that follow the program's name. Returns the page that they ask for, as --help does, or "".
  // Throws UsageError.
  std::string Parse(std::vector<std::string> words);

  // After Parse.
  bool was_given() const;                   // this command
  std::string file() const;                 // path of the configuration file, or ""
  std::vector<OptionState> States() const;  // of all options but the file's, in the order of their rows, --help first

  bool HasOption(const std::string& name) const;   // "--minimal"
  bool HasCommand(const std::string& name) const;  // "voxelize"
  CommandFacts Describe() const;

 private:
  struct Library;
  explicit CommandParser(std::unique_ptr<Library> library);

  std::unique_ptr<Library> library_;
  std::vector<std::unique_ptr<CommandParser>> commands_;
};

}  // namespace latvox

#endif  // LATVOX_MANUAL_COMMAND_PARSER_H_
