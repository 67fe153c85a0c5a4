#include "server/config/settings.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"

namespace latvox {
namespace {

// Those that tell instead of set.
bool Tells(const std::string& name) {
  return name == "help" || name == "version" || name == "man" || name == "check-config";
}

Reload ReloadOf(const std::string& name) {
  if (name == "log-level") return Reload::kValue;
  for (const char* file : {"token-file", "tls-cert", "tls-key", "tls-client-ca"}) {
    if (name == file) return Reload::kContent;
  }
  return Reload::kNo;
}

std::string Literal(const std::string& text) {
  double number = 0;
  if (text == "true" || text == "false" || absl::SimpleAtod(text, &number)) return text;
  // The configuration file's reader knows no escapes, but two kinds of quotes.
  const char* quote = absl::StrContains(text, '"') ? "'" : "\"";
  return absl::StrCat(quote, text, quote);
}

std::vector<std::string> ValuesOf(const CLI::Option& option) {
  if (option.count() > 0) return option.reduced_results();
  const std::string text = option.get_default_str();
  if (text.size() < 2 || text.front() != '[') return {text};
  return absl::StrSplit(text.substr(1, text.size() - 2), ',');  // a list, as CLI11 writes it
}

std::string ValueOf(const CLI::Option& option) {
  const std::vector<std::string> values = ValuesOf(option);
  if (option.get_expected_max() > 1) {
    return absl::StrCat(
        "[", absl::StrJoin(values, ", ", [](std::string* out, const std::string& value) { *out += Literal(value); }),
        "]");
  }
  return values.empty() || values.front().empty() ? "" : Literal(values.front());
}

std::string SourceOf(const CLI::App& app, const CLI::Option& option) {
  // What the command line has, CLI11 lists.
  const auto& flags = app.parse_order();
  if (std::find(flags.begin(), flags.end(), &option) != flags.end()) return "flag";
  if (option.count() == 0) return "default";
  const char* environment = option.get_envname().empty() ? nullptr : std::getenv(option.get_envname().c_str());
  if (environment != nullptr && *environment != '\0') return absl::StrCat("environment ", option.get_envname());
  return absl::StrCat("file ", app.get_config_ptr()->as<std::string>());
}

absl::string_view Mark(const Setting& setting) {
  if (setting.reload == Reload::kContent) return "; read again when it changes, or on SIGHUP";
  return setting.reload == Reload::kValue && FileDecides(setting)
             ? "; the file's value holds when that changes, or on SIGHUP"
             : "";
}

}  // namespace

bool FileDecides(const Setting& setting) {
  return setting.source == "default" || absl::StartsWith(setting.source, "file ");
}

std::vector<Setting> SettingsOf(const CLI::App& app) {
  std::vector<Setting> settings;
  for (const CLI::Option* option : app.get_options()) {
    const std::string name = option->get_single_name();
    if (Tells(name) || option == app.get_config_ptr()) continue;
    settings.push_back({name, ValueOf(*option), SourceOf(app, *option), ReloadOf(name)});
  }
  return settings;
}

std::string ToToml(const std::vector<Setting>& settings) {
  std::string text;
  for (const Setting& setting : settings) {
    const std::string line = setting.value.empty() ? absl::StrCat("# ", setting.name, " is not set")
                                                   : absl::StrCat(setting.name, " = ", setting.value);
    absl::StrAppendFormat(&text, "%-44s # %s%s\n", line, setting.source, Mark(setting));
  }
  return text;
}

std::vector<std::string> ChangedForRestart(const std::vector<Setting>& before, const std::vector<Setting>& after) {
  std::vector<std::string> names;
  for (size_t n = 0; n < std::min(before.size(), after.size()); ++n) {
    if (before[n].reload != Reload::kValue && before[n].value != after[n].value) names.push_back(after[n].name);
  }
  return names;
}

}  // namespace latvox
