#include "deploy/manual/command_parser.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <istream>
#include <sstream>
#include <utility>

#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "absl/strings/string_view.h"

namespace latvox {
namespace {

using Words = std::vector<std::string>;

// The library lets the file win over the environment.
class FileBelow : public CLI::ConfigTOML {
 public:
  explicit FileBelow(std::function<bool(const std::string&)> is_above) : is_above_(std::move(is_above)) {}

  std::vector<CLI::ConfigItem> from_config(std::istream& input) const override {
    std::vector<CLI::ConfigItem> settings = CLI::ConfigTOML::from_config(input);
    std::erase_if(settings, [this](const CLI::ConfigItem& item) { return is_above_(item.name); });
    return settings;
  }

 private:
  const std::function<bool(const std::string&)> is_above_;
};

// Adds the option that writes a target. One call for all types: the library's templates cost a second of compilation
// for each.
struct Adder {
  CLI::App& app;
  const OptionRow& row;

  CLI::Option* operator()(bool* target) const { return app.add_flag(row.names, *target, row.help); }

  CLI::Option* operator()(std::optional<bool>* target) const {
    return app.add_flag(row.names)
        ->description(row.help)
        ->check(CLI::IsMember({"true", "false"}))
        ->each([target](const std::string& flag) { *target = flag == "true"; });
  }

  template <class T>
  CLI::Option* operator()(T* target) const {
    return Take(TypeName(T()), [target](const Words& words) { return CLI::detail::lexical_cast(words[0], *target); });
  }

  template <class T>
  CLI::Option* operator()(std::optional<T>* target) const {
    return Take(TypeName(T()),
                [target](const Words& words) { return CLI::detail::lexical_cast(words[0], target->emplace()); });
  }

  CLI::Option* operator()(std::string* target) const {
    return Take("TEXT", [target](const Words& words) { return *target = words[0], true; });
  }

  CLI::Option* operator()(std::vector<std::string>* target) const {
    CLI::Option* option = Take("TEXT", [target](const Words& words) { return *target = words, true; });
    if (!row.one_each_time) return option->expected(CLI::detail::expected_max_vector_size);
    // What follows may be a positional one.
    return option->take_all()->expected(1)->allow_extra_args(false);
  }

  CLI::Option* operator()(const std::function<void(const std::string&)>& function) const {
    return Take("TEXT", [function](const Words& words) { return function(words[0]), true; });
  }

  CLI::Option* Take(const char* type, CLI::callback_t take) const {
    return app.add_option(row.names, std::move(take), row.help)->type_name(row.value.empty() ? type : row.value);
  }

  static const char* TypeName(int) { return "INT"; }
  static const char* TypeName(uint64_t) { return "UINT"; }
  static const char* TypeName(uint32_t) { return "UINT"; }
  static const char* TypeName(double) { return "FLOAT"; }
};

CLI::Validator Checked(const OptionCheck& check) {
  return CLI::Validator([wrong = check.wrong](const std::string& word) { return wrong(word); }, check.name);
}

void AddRow(CLI::App& app, const OptionRow& row) {
  CLI::Option* option = std::visit(Adder{app, row}, row.target);
  if (row.required) option->required();
  if (row.delimiter != 0) option->delimiter(row.delimiter);
  if (!row.words.empty()) option->check(CLI::IsMember(row.words));
  // Of two that change the word, the one that is added last comes first.
  if (row.is_size) option->transform(CLI::AsSizeValue(false));
  if (row.is_size && !row.checks.empty()) option->transform(Checked(row.checks.front()));
  for (const OptionCheck& check : row.checks) option->check(Checked(check));
  if (!row.environment.empty()) option->envname(row.environment);
  if (!row.standard.empty()) option->default_str(row.standard);
  if (!row.in_file) option->configurable(false);
}

// "TEXT:{a,b}": what the library makes of a type's name and the words that a check allows.
std::vector<std::string> ChoicesOf(absl::string_view type) {
  const size_t begin = type.find('{'), end = type.rfind('}');
  if (begin == absl::string_view::npos || end == absl::string_view::npos) return {};
  return absl::StrSplit(type.substr(begin + 1, end - begin - 1), ',');
}

OptionFacts DescribeOption(const CLI::Option& option) {
  OptionFacts facts;
  for (const std::string& name : option.get_snames()) facts.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) facts.names.push_back("--" + name);
  const bool flag = option.get_items_expected_max() == 0;
  if (!flag) {
    const std::string type = option.get_type_name();
    facts.choices = ChoicesOf(type);
    facts.value = type.substr(0, type.find(':'));
    if (!facts.choices.empty() && facts.value == "TEXT") facts.value = absl::StrJoin(facts.choices, "|");
    facts.standard = option.get_default_str();
  }
  facts.description = option.get_description();
  facts.group = option.get_group();
  facts.environment = option.get_envname();
  facts.required = option.get_required();
  facts.several = option.get_expected_max() > 1 || option.get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll;
  return facts;
}

CommandFacts DescribeApp(const CLI::App& app) {
  CommandFacts facts;
  facts.name = app.get_name();
  facts.description = app.get_description();
  facts.footer = app.get_footer();
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group().empty()) continue;
    (option->nonpositional() ? facts.options : facts.positionals).push_back(DescribeOption(*option));
  }
  for (const CLI::App* command : app.get_subcommands([](const CLI::App* sub) { return !sub->get_group().empty(); })) {
    facts.commands.push_back(DescribeApp(*command));
  }
  return facts;
}

Words ValuesOf(const CLI::Option& option) {
  if (option.count() > 0) return option.reduced_results();
  const std::string text = option.get_default_str();
  if (text.size() < 2 || text.front() != '[') return {text};
  return absl::StrSplit(text.substr(1, text.size() - 2), ',');
}

OptionState::Source SourceOf(const CLI::App& app, const CLI::Option& option) {
  using Source = OptionState::Source;
  // What the command line has, the library lists.
  const auto& flags = app.parse_order();
  if (std::find(flags.begin(), flags.end(), &option) != flags.end()) return Source::kFlag;
  if (option.count() == 0) return Source::kDefault;
  const char* variable = option.get_envname().empty() ? nullptr : std::getenv(option.get_envname().c_str());
  return variable != nullptr && *variable != '\0' ? Source::kEnvironment : Source::kFile;
}

}  // namespace

// A program has an app of its own; a command has one of its program's.
struct CommandParser::Library {
  std::unique_ptr<CLI::App> own;
  CLI::App& app;
};

CommandParser::CommandParser(const std::string& description, const std::string& name) {
  auto own = std::make_unique<CLI::App>(description, name);
  CLI::App& app = *own;
  library_.reset(new Library{std::move(own), app});
}

CommandParser::CommandParser(std::unique_ptr<Library> library) : library_(std::move(library)) {}

CommandParser::~CommandParser() = default;

void CommandParser::Add(const std::vector<OptionRow>& rows) {
  CLI::App& app = library_->app;
  for (const OptionRow& row : rows) {
    if (!row.group.empty()) app.option_defaults()->group(row.group);
    AddRow(app, row);
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

void CommandParser::SetVersion(const std::string& text) { library_->app.set_version_flag("--version", text); }

void CommandParser::ReadFile(const std::string& option, const std::string& path, const std::string& help,
                             std::function<bool(const std::string& name)> is_above) {
  CLI::App& app = library_->app;
  app.set_config(option, path, help, /*config_required=*/!path.empty());
  app.get_config_ptr()->type_name("FILE");
  app.allow_config_extras(CLI::config_extras_mode::error);
  app.config_formatter(std::make_shared<FileBelow>(std::move(is_above)));
}

CommandParser& CommandParser::AddCommand(const std::string& name, const std::string& description) {
  library_->app.require_subcommand(0, 1);
  CLI::App& app = *library_->app.add_subcommand(name, description);
  std::unique_ptr<Library> library(new Library{nullptr, app});
  commands_.push_back(std::unique_ptr<CommandParser>(new CommandParser(std::move(library))));
  return *commands_.back();
}

std::string CommandParser::Parse(std::vector<std::string> words) try {
  std::reverse(words.begin(), words.end());  // as the library wants vectors
  library_->app.parse(std::move(words));
  return "";
} catch (const CLI::Success& wanted) {
  std::ostringstream page;
  library_->app.exit(wanted, page, page);
  return page.str();
} catch (const CLI::ExtrasError& error) {
  throw UsageError(error.what(), /*is_unknown_word=*/true);
} catch (const CLI::ParseError& error) {
  throw UsageError(error.what());
}

bool CommandParser::was_given() const { return library_->app.parsed(); }

std::string CommandParser::file() const {
  const CLI::Option* option = library_->app.get_config_ptr();
  return option == nullptr ? "" : option->as<std::string>();
}

std::vector<OptionState> CommandParser::States() const {
  const CLI::App& app = library_->app;
  std::vector<OptionState> states;
  for (const CLI::Option* option : app.get_options()) {
    if (option == app.get_config_ptr()) continue;
    states.push_back({option->get_single_name(), ValuesOf(*option), option->get_expected_max() > 1,
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

CommandFacts CommandParser::Describe() const { return DescribeApp(library_->app); }

}  // namespace latvox
