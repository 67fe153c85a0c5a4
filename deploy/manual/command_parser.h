// Parses command lines from tables of options. Only its .cc includes the library underneath, CLI11.
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
  std::vector<std::string> values;  // as given, or the default
  bool is_list = false;             // takes several
  bool is_text = false;             // neither a number nor a switch
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

  // Call these before Parse.
  void Add(const std::vector<OptionRow>& rows);
  void Exclude(const OptionPairs& pairs);  // of added options
  void Need(const OptionPairs& pairs);     // of added options
  void SetFooter(const std::string& text);
  // Adds --version, which prints this text.
  void SetVersion(const std::string& text);
  // Adds an option for a configuration file: TOML, with the options' long names as keys, and their values in TOML's own
  // types. Errors of the file name its path, the line, the key and the value; those of a variable name the variable.
  //   path       default path of the file, which must exist; empty: no file
  //   is_above   whether another source overrides the file for this option, named without dashes
  void ReadFile(const std::string& option, const std::string& path, const std::string& help,
                std::function<bool(const std::string& name)> is_above);
  // The parser owns the command. A command line has at most one.
  CommandParser& AddCommand(const std::string& name, const std::string& description);

  // Parses the words that follow the program's name. Returns the page that --help or --version asks for, or "".
  // Throws UsageError. Unknown words come first, in the order typed, with the nearest known one.
  std::string Parse(std::vector<std::string> words);

  // After Parse.
  bool was_given() const;                   // this command
  std::string file() const;                 // path of the configuration file, or ""
  std::vector<OptionState> States() const;  // of all options except the file's, in the order of rows, --help first

  bool HasOption(const std::string& name) const;   // "--minimal"
  bool HasCommand(const std::string& name) const;  // "voxelize"
  CommandFacts Describe() const;

 private:
  struct Library;
  class File;
  explicit CommandParser(std::unique_ptr<Library> library);
  const CommandParser* GivenCommand() const;               // after Parse; null: none
  std::string PathOf(const CommandParser* command) const;  // "latvox voxelize", or "latvox" if null
  // Throws UsageError for the first word that the command line has and the tables do not.
  void RefuseUnknownWord() const;
  // Returns the error of an option with the file or variable that its value comes from.
  std::string WithPlace(const std::string& error) const;
  // Returns what the library's error of an option is about.
  UsageDetails DetailsOf(const std::string& error) const;

  std::unique_ptr<Library> library_;
  std::vector<std::unique_ptr<CommandParser>> commands_;
};

}  // namespace latvox

#endif  // LATVOX_MANUAL_COMMAND_PARSER_H_
