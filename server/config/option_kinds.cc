#include "server/config/option_kinds.h"

#include <cmath>
#include <cstdlib>
#include <istream>
#include <memory>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"

namespace latvox {
namespace {

// Empty if it is not set.
std::string FromEnvironment(absl::string_view flag) {
  const char* value = std::getenv(EnvironmentName(flag).c_str());
  return value == nullptr ? "" : value;
}

// CLI11 lets the file win over the environment.
class ConfigBelowEnvironment : public CLI::ConfigTOML {
 public:
  std::vector<CLI::ConfigItem> from_config(std::istream& input) const override {
    std::vector<CLI::ConfigItem> settings = CLI::ConfigTOML::from_config(input);
    std::erase_if(settings,
                  [](const CLI::ConfigItem& item) { return !FromEnvironment(absl::StrCat("--", item.name)).empty(); });
    return settings;
  }
};

}  // namespace

std::string EnvironmentName(absl::string_view flag) {
  return absl::StrCat("LATVOX_", absl::AsciiStrToUpper(absl::StrReplaceAll(flag.substr(2), {{"-", "_"}})));
}

const CLI::Validator& AtLeastOne() {
  static const auto& validator = *new CLI::Validator(
      [](std::string& value) { return value == "0" ? std::string("0 is below 1") : std::string(); }, "of at least 1");
  return validator;
}

const CLI::Validator& WithoutSign() {
  static const auto& validator = *new CLI::Validator(
      [](std::string& value) {
        const bool is_number = !value.empty() && absl::ascii_isdigit(static_cast<uint8_t>(value[0]));
        const bool is_octal_or_hexadecimal =
            value.size() > 1 && value[0] == '0' && absl::StrContains("0123456789xX", value[1]);
        return is_number && !is_octal_or_hexadecimal ? ""
                                                     : absl::StrCat("\"", value, "\" is not a whole number from 0 on");
      },
      "");
  return validator;
}

// Of two that change the value, the one that is added last comes first.
CLI::Option* TakeBytes(CLI::Option* option) {
  return option->transform(CLI::AsSizeValue(false))->transform(WithoutSign());
}

CLI::Option* AddBytes(CLI::App& app, const std::string& flag, uint64_t& value, const std::string& description) {
  return TakeBytes(Add(app, flag, value, description))->check(AtLeastOne());
}

CLI::Option* AddSeconds(CLI::App& app, const std::string& flag, double least, absl::Duration& value,
                        const std::string& description) {
  constexpr double kMost = 86400;
  return app
      .add_option_function<double>(
          flag, [&value](double seconds) { value = absl::Seconds(seconds); }, description)
      ->envname(EnvironmentName(flag))
      ->default_str(absl::StrCat(absl::ToDoubleSeconds(value)))
      ->type_name("SECONDS")
      ->check(CLI::Range(least, kMost))
      ->check(CLI::Validator(
          [](const std::string& text) {
            double seconds = 0;
            const bool is_finite = absl::SimpleAtod(text, &seconds) && std::isfinite(seconds);
            return is_finite ? "" : absl::StrCat("\"", text, "\" is not a number");
          },
          ""));
}

CLI::Option* AddSwitch(CLI::App& app, const std::string& flag, bool& value, const std::string& description) {
  return app.add_flag(flag, value, description)->envname(EnvironmentName(flag))->default_str("false");
}

// CLI11 does not look at the environment for the file's own name.
void AddConfigurationFile(CLI::App& app) {
  const std::string named = FromEnvironment("--config");
  app.set_config("--config", named,
                 absl::StrCat("Configuration file (TOML) with the options' long names as keys (",
                              EnvironmentName("--config"), ")"),
                 /*config_required=*/!named.empty());
  app.get_config_ptr()->type_name("FILE");
  app.allow_config_extras(CLI::config_extras_mode::error);
  app.config_formatter(std::make_shared<ConfigBelowEnvironment>());
}

}  // namespace latvox
