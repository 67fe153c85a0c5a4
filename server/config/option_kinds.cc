#include "server/config/option_kinds.h"

#include <algorithm>
#include <cstdlib>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"

namespace latvox {
namespace {

// Empty if the variable is not set.
std::string FromEnvironment(absl::string_view flag) {
  const char* value = std::getenv(EnvironmentName(flag).c_str());
  return value == nullptr ? "" : value;
}

// Refuses numbers that the library would misread: -1 as 2^64 - 1, and 010 as 8.
std::string CheckWithoutSign(const std::string& text) {
  const bool is_number = !text.empty() && absl::ascii_isdigit(static_cast<uint8_t>(text[0]));
  const bool is_octal_or_hexadecimal = text.size() > 1 && text[0] == '0' && absl::StrContains("0123456789xX", text[1]);
  return is_number && !is_octal_or_hexadecimal ? "" : absl::StrCat("\"", text, "\" is not a whole number from 0 on");
}

std::string CheckDigits(const std::string& text) {
  const auto is_digit = [](char c) { return absl::ascii_isdigit(static_cast<uint8_t>(c)); };
  return std::all_of(text.begin(), text.end(), is_digit) ? "" : absl::StrCat("\"", text, "\" is not a whole number");
}

std::string CheckAtLeastOne(const std::string& text) { return text == "0" ? "0 is below 1" : ""; }

std::string NotInRange(absl::string_view text, absl::string_view kind, double low, double high) {
  return absl::StrCat("\"", text, "\" is not a ", kind, " from ", low, " to ", high);
}

OptionRow Row(const std::string& flag, OptionTarget target, const std::string& help, const std::string& standard) {
  return {.names = flag,
          .target = std::move(target),
          .help = help,
          .environment = EnvironmentName(flag),
          .standard = standard};
}

template <class T>
OptionRow NumberRow(const std::string& flag, T& value, const std::string& help) {
  OptionRow row = Row(flag, &value, help, absl::StrCat(value));
  row.checks = {{CheckWithoutSign}, {CheckDigits}};  // the second one sees sizes as numbers
  return row;
}

}  // namespace

std::string EnvironmentName(absl::string_view flag) {
  return absl::StrCat("LATVOX_", absl::AsciiStrToUpper(absl::StrReplaceAll(flag.substr(2), {{"-", "_"}})));
}

OptionRow Text(const std::string& flag, std::string& value, const std::string& help) {
  return Row(flag, &value, help, value);
}

OptionRow File(const std::string& flag, std::string& path, const std::string& help) {
  OptionRow row = Text(flag, path, help);
  row.value = "FILE";
  return row;
}

OptionRow Address(const std::string& flag, std::string& value, const std::string& help) {
  OptionRow row = Text(flag, value, help);
  row.value = "ADDRESS";
  return row;
}

OptionRow Texts(const std::string& flag, std::vector<std::string>& values, const std::string& help) {
  OptionRow row = Row(flag, &values, help, absl::StrCat("[", absl::StrJoin(values, ","), "]"));
  row.value = "ADDRESS";
  row.delimiter = ',';
  return row;
}

OptionRow Number(const std::string& flag, uint64_t& value, const std::string& help) {
  return NumberRow(flag, value, help);
}

OptionRow Number(const std::string& flag, uint32_t& value, const std::string& help) {
  return NumberRow(flag, value, help);
}

OptionRow NumberTo(int most, const std::string& flag, int& value, const std::string& help) {
  OptionRow row = NumberRow(flag, value, help);
  row.checks.push_back({[most](const std::string& text) -> std::string {
                          int number = 0;
                          const bool is_good = absl::SimpleAtoi(text, &number) && number >= 0 && number <= most;
                          return is_good ? "" : NotInRange(text, "whole number", 0, most);
                        },
                        absl::StrCat("0 to ", most)});
  return row;
}

OptionRow Bytes(const std::string& flag, uint64_t& value, const std::string& help) {
  OptionRow row = NumberRow(flag, value, help);
  row.is_size = true;
  row.most = uint64_t{1} << 47;  // 128 TiB, the addresses of a process
  return row;
}

OptionRow AtLeastOne(OptionRow row) {
  row.checks.push_back({CheckAtLeastOne, "at least 1"});
  return row;
}

OptionRow Seconds(const std::string& flag, double least, absl::Duration& value, const std::string& help) {
  constexpr double kMost = 86400;
  const auto set = [&value](const std::string& text) {
    double seconds = 0;
    if (absl::SimpleAtod(text, &seconds)) value = absl::Seconds(seconds);
  };
  const auto check_range = [least](const std::string& text) -> std::string {
    double seconds = 0;
    const bool is_good = absl::SimpleAtod(text, &seconds) && seconds >= least && seconds <= kMost;
    return is_good ? "" : NotInRange(text, "number", least, kMost);
  };
  OptionRow row = Row(flag, set, help, absl::StrCat(absl::ToDoubleSeconds(value)));
  row.value = "SECONDS";
  row.is_number = true;
  row.checks = {{check_range, absl::StrCat(least, " to ", kMost)}};
  return row;
}

OptionRow Switch(const std::string& flag, bool& value, const std::string& help) {
  return Row(flag, &value, help, "false");
}

// The library does not read the environment for the file's own name.
void AddConfigurationFile(CommandParser& parser) {
  parser.ReadFile("--config", FromEnvironment("--config"),
                  absl::StrCat("Configuration file (TOML) with the options' long names as keys; its variable is ",
                               EnvironmentName("--config")),
                  [](const std::string& name) { return !FromEnvironment(absl::StrCat("--", name)).empty(); });
}

}  // namespace latvox
