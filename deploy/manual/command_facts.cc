#include "deploy/manual/command_facts.h"

#include <CLI/CLI.hpp>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "absl/strings/string_view.h"

namespace latvox {
namespace {

// "TEXT:{a,b}": what CLI11 makes of a type's name and the words that a check allows.
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

}  // namespace

CommandFacts Describe(const CLI::App& app) {
  CommandFacts facts;
  facts.name = app.get_name();
  facts.description = app.get_description();
  facts.footer = app.get_footer();
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group().empty()) continue;
    (option->nonpositional() ? facts.options : facts.positionals).push_back(DescribeOption(*option));
  }
  for (const CLI::App* command : app.get_subcommands([](const CLI::App* sub) { return !sub->get_group().empty(); })) {
    facts.commands.push_back(Describe(*command));
  }
  return facts;
}

}  // namespace latvox
