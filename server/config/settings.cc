#include "server/config/settings.h"

#include <algorithm>
#include <charconv>
#include <iterator>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"

namespace latvox {
namespace {

// Options that show something instead of setting it.
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

// Returns a basic string of TOML.
std::string Quoted(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (absl::ascii_iscntrl(static_cast<uint8_t>(c))) {
      absl::StrAppendFormat(&quoted, "\\u%04X", static_cast<unsigned>(c));
    } else {
      if (c == '"' || c == '\\') quoted += '\\';
      quoted += c;
    }
  }
  return quoted + '"';
}

// A flag or variable may have given a number as .5 or 1., which TOML does not know.
std::string Number(const std::string& text) {
  double number = 0;
  const bool is_whole = absl::StrContains("0123456789", text.back()) && !absl::StrContains(text, '.');
  if (is_whole || !absl::SimpleAtod(text, &number)) return text;
  char digits[64];
  return {digits, std::to_chars(digits, std::end(digits), number).ptr};
}

std::string ValueOf(const OptionState& option) {
  const std::vector<std::string>& values = option.values;
  if (option.is_list) {
    const auto append = [](std::string* out, const std::string& value) { *out += Quoted(value); };
    return absl::StrCat("[", absl::StrJoin(values, ", ", append), "]");
  }
  if (values.empty() || values.front().empty()) return "";
  return option.is_text ? Quoted(values.front()) : Number(values.front());
}

std::string SourceOf(const OptionState& option, const std::string& file) {
  switch (option.source) {
    case OptionState::Source::kFlag:
      return "flag";
    case OptionState::Source::kEnvironment:
      return absl::StrCat("environment ", option.environment);
    case OptionState::Source::kFile:
      return absl::StrCat("file ", file);
    case OptionState::Source::kDefault:
      break;
  }
  return "default";
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

std::vector<Setting> SettingsOf(const std::vector<OptionState>& options, const std::string& file) {
  std::vector<Setting> settings;
  for (const OptionState& option : options) {
    if (Tells(option.name)) continue;
    settings.push_back({option.name, ValueOf(option), SourceOf(option, file), ReloadOf(option.name)});
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
