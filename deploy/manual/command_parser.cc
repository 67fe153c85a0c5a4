#include "deploy/manual/command_parser.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <set>
#include <sstream>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "deploy/manual/help.h"
#include "deploy/manual/option_values.h"
#include "deploy/manual/toml_file.h"
#include "deploy/manual/unknown_word.h"

namespace latvox {
namespace {

using Words = std::vector<std::string>;

constexpr char kHelpNames[] = "-h,--help", kHelp[] = "Print this help and exit";

std::string AllNames(const OptionRow& row) {
  if (row.names[0] != '-' && !row.value.empty()) return row.value;  // errors name an argument as help does
  return absl::StrCat(row.names, row.aliases.empty() ? "" : ",", row.aliases);
}

// Adds the option that writes a target. All types share one call, because each instance of the library's templates
// costs a second of compilation.
struct Adder {
  CLI::App& app;
  const OptionRow& row;

  CLI::Option* operator()(bool* target) const { return app.add_flag(AllNames(row), *target, row.help); }

  CLI::Option* operator()(std::optional<bool>* target) const {
    return app.add_flag(row.names)
        ->description(row.help)
        ->check(CLI::IsMember({"true", "false"}))
        ->each([target](const std::string& flag) { *target = flag == "true"; });
  }

  template <class T>
  CLI::Option* operator()(T* target) const {
    return Take([target](const Words& words) { return CLI::detail::lexical_cast(words[0], *target); });
  }

  template <class T>
  CLI::Option* operator()(std::optional<T>* target) const {
    return Take([target](const Words& words) { return CLI::detail::lexical_cast(words[0], target->emplace()); });
  }

  CLI::Option* operator()(std::string* target) const {
    return Take([target](const Words& words) { return *target = words[0], true; });
  }

  CLI::Option* operator()(std::vector<std::string>* target) const {
    CLI::Option* option = Take([target](const Words& words) { return *target = words, true; });
    if (!row.one_each_time) return option->expected(CLI::detail::expected_max_vector_size);
    // The next word may be a positional option.
    return option->take_all()->expected(1)->allow_extra_args(false);
  }

  CLI::Option* operator()(const std::function<void(const std::string&)>& function) const {
    return Take([function](const Words& words) { return function(words[0]), true; });
  }

  CLI::Option* Take(CLI::callback_t take) const { return app.add_option(AllNames(row), std::move(take), row.help); }
};

CLI::Validator Checked(const OptionCheck& check) {
  return CLI::Validator([wrong = check.wrong](const std::string& word) { return wrong(word).text; }, "");
}

// Replaces "1GiB" with its number of bytes.
CLI::Validator Size(uint64_t most) {
  const auto convert = [most, in_bytes = CLI::AsSizeValue(false)](std::string& word) -> std::string {
    const std::string given = word;
    uint64_t number = 0;
    try {
      if (!in_bytes(word).empty() || !absl::SimpleAtoi(word, &number)) number = UINT64_MAX;
    } catch (const CLI::ValidationError& error) {
      if (!absl::StrContains(error.what(), "overflow")) {
        return absl::StrCat("\"", given, "\" is not a number of bytes, such as 1073741824 or 1GiB");
      }
      number = UINT64_MAX;
    }
    return number <= most ? "" : absl::StrCat(given, " exceeds ", SizeText(absl::StrCat(most)));
  };
  return CLI::Validator(convert, "");
}

CLI::Option* AddRow(CLI::App& app, const OptionRow& row) {
  CLI::Option* option = std::visit(Adder{app, row}, row.target);
  if (row.required) option->required();
  if (row.delimiter != 0) option->delimiter(row.delimiter);
  const auto to_listed = [words = row.words](std::string& word) { return ToListed(words, word); };
  if (!row.words.empty()) option->transform(CLI::Validator(to_listed, ""));
  // Transforms run in the reverse order of their addition.
  const uint64_t most = MostOf(row);
  if (row.is_size) option->transform(Size(most));
  if (row.is_size && !row.checks.empty()) option->transform(Checked(row.checks.front()));
  for (const OptionCheck& check : row.checks) option->check(Checked(check));
  if (most != 0) option->check(Checked({[most](const std::string& word) { return AboveMost(word, most); }}));
  if (!row.environment.empty() && std::holds_alternative<bool*>(row.target))
    option->transform(CLI::Validator(ToTruth, ""));
  if (!row.environment.empty()) option->envname(row.environment);
  if (!row.standard.empty()) option->default_str(row.standard);
  if (!row.in_file) option->configurable(false);
  return option;
}

// CLI11 2.4 converts the first of no results, and crashes, where 2.3 took the default.
std::string PathOfFile(const CLI::Option& option) {
  return option.empty() ? option.get_default_str() : option.as<std::string>();
}

std::string LongName(const CLI::Option& option) {
  return option.get_lnames().empty() ? option.get_name() : "--" + option.get_lnames().front();
}

// In the order of definition. The library's sets are in the order of addresses.
std::vector<std::string> NamesOf(const CLI::App& app, const std::set<CLI::Option*>& options) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    const auto is_it = [option](const CLI::Option* one) { return one == option; };
    if (std::any_of(options.begin(), options.end(), is_it)) names.push_back(LongName(*option));
  }
  return names;
}

OptionFacts DescribeOption(const CLI::App& app, const CLI::Option& option, const OptionRow* row) {
  OptionFacts facts;
  const Words aliases = row == nullptr ? Words() : absl::StrSplit(row->aliases, ',');
  const auto add = [&](const std::string& name) {
    if (std::find(aliases.begin(), aliases.end(), name) == aliases.end()) facts.names.push_back(name);
  };
  for (const std::string& name : option.get_snames()) add("-" + name);
  for (const std::string& name : option.get_lnames()) add("--" + name);
  const bool flag = option.get_items_expected_max() == 0;
  if (row != nullptr && !flag) DescribeValue(*row, facts);
  if (row == nullptr && !flag) facts.value = option.get_type_name();
  facts.description = option.get_description();
  facts.group = option.get_group();
  facts.environment = option.get_envname();
  facts.excludes = NamesOf(app, option.get_excludes());
  facts.needs = NamesOf(app, option.get_needs());
  facts.required = option.get_required();
  facts.several = option.get_expected_max() > 1 || option.get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll;
  return facts;
}

Words ValuesOf(const CLI::Option& option) {
  if (option.count() > 0) return option.reduced_results();
  const std::string text = option.get_default_str();
  if (text.size() < 2 || text.front() != '[') return {text};
  return absl::StrSplit(text.substr(1, text.size() - 2), ',');
}

// CLI11 2.4 ignores a variable whose value is wrong. 2.3 refuses it.
void TakeIgnoredVariables(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    const std::string value = ValueOfVariable(option->get_envname());
    if (option->count() > 0 || value.empty()) continue;
    option->add_result(value);
    option->run_callback();
  }
}

OptionState::Source SourceOf(const CLI::App& app, const CLI::Option& option) {
  using Source = OptionState::Source;
  // The library lists the options that the command line has.
  const auto& flags = app.parse_order();
  if (std::find(flags.begin(), flags.end(), &option) != flags.end()) return Source::kFlag;
  if (option.count() == 0) return Source::kDefault;
  return ValueOfVariable(option.get_envname()).empty() ? Source::kFile : Source::kEnvironment;
}

}  // namespace

// A program owns its app. The app of a command belongs to its program's.
struct CommandParser::Library {
  std::unique_ptr<CLI::App> own;
  CLI::App& app;
  std::map<const CLI::Option*, OptionRow> rows = {};
  std::map<std::string, FileSetting> settings = {};  // of the configuration file, by their keys
};

// Reads the configuration file.
class CommandParser::File : public CLI::ConfigTOML {
 public:
  File(Library& library, std::function<bool(const std::string&)> is_above)
      : library_(library), is_above_(std::move(is_above)) {}

  // The library opens the file, but only its own reader uses the stream, and lets the file win over the environment.
  std::vector<CLI::ConfigItem> from_config(std::istream&) const override {
    RowsOfKeys rows;
    for (const auto& [option, row] : library_.rows) {
      if (!option->get_lnames().empty()) rows.emplace(option->get_lnames().front(), &row);
    }
    std::vector<CLI::ConfigItem> found;
    for (FileSetting& setting : ReadSettings(PathOfFile(*library_.app.get_config_ptr()), rows)) {
      if (!is_above_(setting.key)) {
        CLI::ConfigItem& item = found.emplace_back();
        item.name = setting.key;
        item.inputs = setting.words;
      }
      library_.settings.emplace(setting.key, std::move(setting));
    }
    return found;
  }

 private:
  Library& library_;
  const std::function<bool(const std::string&)> is_above_;
};

CommandParser::CommandParser(const std::string& description, const std::string& name) {
  auto own = std::make_unique<CLI::App>(description, name);
  CLI::App& app = *own;
  app.set_help_flag(kHelpNames, kHelp);
  library_.reset(new Library{std::move(own), app});
}

CommandParser::CommandParser(std::unique_ptr<Library> library) : library_(std::move(library)) {}

CommandParser::~CommandParser() = default;

void CommandParser::Add(const std::vector<OptionRow>& rows) {
  CLI::App& app = library_->app;
  for (const OptionRow& row : rows) {
    if (!row.group.empty()) app.option_defaults()->group(row.group);
    library_->rows.emplace(AddRow(app, row), row);
  }
}

void CommandParser::Exclude(const OptionPairs& pairs) {
  CLI::App& app = library_->app;
  for (const auto& [one, other] : pairs) app.get_option(one)->excludes(app.get_option(other));
}

void CommandParser::Need(const OptionPairs& pairs) {
  CLI::App& app = library_->app;
  for (const auto& [one, other] : pairs) app.get_option(one)->needs(app.get_option(other));
}

void CommandParser::SetFooter(const std::string& text) { library_->app.footer(text); }

void CommandParser::SetVersion(const std::string& text) {
  library_->app.set_version_flag("-V,--version", text, "Print the version and exit");
}

void CommandParser::ReadFile(const std::string& option, const std::string& path, const std::string& help,
                             std::function<bool(const std::string& name)> is_above) {
  CLI::App& app = library_->app;
  app.set_config(option, path, help, /*config_required=*/!path.empty());
  app.get_config_ptr()->type_name("FILE");
  app.allow_config_extras(CLI::config_extras_mode::error);
  app.config_formatter(std::make_shared<File>(*library_, std::move(is_above)));
}

CommandParser& CommandParser::AddCommand(const std::string& name, const std::string& description) {
  library_->app.require_subcommand(0, 1);
  CLI::App& app = *library_->app.add_subcommand(name, description);
  app.set_help_flag(kHelpNames, kHelp);
  std::unique_ptr<Library> library(new Library{nullptr, app});
  commands_.push_back(std::unique_ptr<CommandParser>(new CommandParser(std::move(library))));
  return *commands_.back();
}

const CommandParser* CommandParser::GivenCommand() const {
  for (const auto& command : commands_) {
    if (command->was_given()) return command.get();
  }
  return nullptr;
}

std::string CommandParser::PathOf(const CommandParser* command) const {
  const std::string& name = library_->app.get_name();
  return command == nullptr ? name : absl::StrCat(name, " ", command->library_->app.get_name());
}

// The library notices a missing option before an unknown one, which may be the missing one misspelled.
void CommandParser::RefuseUnknownWord() const {
  const CommandParser* const command = GivenCommand();
  const Words before = library_->app.remaining();
  const Words unknown = library_->app.remaining(/*recurse=*/true);
  if (unknown.empty()) return;
  const std::string word = unknown[0].substr(0, unknown[0].find('='));
  const std::string page = absl::StrCat(PathOf(command), " --help");
  if (command != nullptr && !before.empty()) {
    throw UsageError(absl::StrCat("\"", word, "\" stands before the command; options follow it, see ", page));
  }
  throw UsageError(UnknownWord(word, command == nullptr ? Describe() : command->Describe(), page));
}

// The library names the option alone, wherever its value comes from.
std::string CommandParser::WithPlace(const std::string& error) const {
  for (const auto& [option, row] : library_->rows) {
    const std::string name = absl::StrCat(option->get_name(), ": ");
    if (!absl::StartsWith(error, name)) continue;
    const std::string wrong = error.substr(name.size());
    const OptionState::Source source = SourceOf(library_->app, *option);
    if (source == OptionState::Source::kEnvironment) return absl::StrCat(row.environment, ": ", wrong);
    const auto setting = library_->settings.find(option->get_lnames().front());
    if (source != OptionState::Source::kFile || setting == library_->settings.end()) break;
    return absl::StrCat(file(), ":", setting->second.line, ": ", setting->first, ": ", wrong);
  }
  return error;
}

UsageDetails CommandParser::DetailsOf(const std::string& error) const {
  const std::string excludes = " excludes ";
  if (const size_t at = error.find(excludes); absl::StartsWith(error, "--") && at != std::string::npos) {
    return {.option = error.substr(0, at), .other = error.substr(at + excludes.size())};
  }
  for (const auto& [option, row] : library_->rows) {
    if (!absl::StartsWith(error, absl::StrCat(option->get_name(), ": "))) continue;
    for (const std::string& word : option->results()) {
      if (auto [text, value, limit] = FindWrong(row, word); !text.empty()) return {LongName(*option), value, limit};
    }
    return {.option = LongName(*option)};
  }
  return {};
}

std::string CommandParser::Parse(std::vector<std::string> words) try {
  std::reverse(words.begin(), words.end());  // as the library wants vectors
  library_->app.parse(std::move(words));
  TakeIgnoredVariables(library_->app);
  return "";
} catch (const CLI::CallForHelp&) {
  if (GivenCommand() == nullptr) RefuseUnknownWord();
  return ToHelp(PathOf(GivenCommand()), GivenCommand() == nullptr ? Describe() : GivenCommand()->Describe());
} catch (const CLI::Success& wanted) {
  std::ostringstream page;
  library_->app.exit(wanted, page, page);
  return page.str();
} catch (const UsageError&) {  // of the configuration file
  RefuseUnknownWord();
  throw;
} catch (const CLI::ParseError& error) {
  RefuseUnknownWord();
  if (error.get_name() == "FileError") ReadSettings(file(), {});  // throws the reason, which the library does not know
  throw UsageError(WithPlace(error.what()), DetailsOf(error.what()));
}

bool CommandParser::was_given() const { return library_->app.parsed(); }

std::string CommandParser::file() const {
  const CLI::Option* option = library_->app.get_config_ptr();
  return option == nullptr ? "" : PathOfFile(*option);
}

std::vector<OptionState> CommandParser::States() const {
  const CLI::App& app = library_->app;
  std::vector<OptionState> states;
  const auto is_text = [this](const CLI::Option* option) {
    const auto row = library_->rows.find(option);
    return row == library_->rows.end() || IsText(row->second);
  };
  for (const CLI::Option* option : app.get_options()) {
    if (option == app.get_config_ptr()) continue;
    states.push_back({option->get_single_name(), ValuesOf(*option), option->get_expected_max() > 1, is_text(option),
                      SourceOf(app, *option), option->get_envname()});
  }
  return states;
}

bool CommandParser::HasOption(const std::string& name) const {
  return library_->app.get_option_no_throw(name) != nullptr;
}

bool CommandParser::HasCommand(const std::string& name) const {
  return std::any_of(commands_.begin(), commands_.end(),
                     [&](const auto& command) { return command->library_->app.check_name(name); });
}

CommandFacts CommandParser::Describe() const {
  const CLI::App& app = library_->app;
  CommandFacts facts;
  facts.name = app.get_name();
  facts.description = app.get_description();
  facts.footer = app.get_footer();
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group().empty()) continue;
    const auto found = library_->rows.find(option);
    const OptionRow* row = found == library_->rows.end() ? nullptr : &found->second;
    (option->nonpositional() ? facts.options : facts.positionals).push_back(DescribeOption(app, *option, row));
  }
  for (const auto& command : commands_) facts.commands.push_back(command->Describe());
  return facts;
}

}  // namespace latvox
