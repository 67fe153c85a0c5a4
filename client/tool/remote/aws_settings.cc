#include "client/tool/remote/aws_settings.h"

#include <cstdlib>
#include <fstream>
#include <map>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"

namespace latvox::client {
namespace {

using Section = std::map<std::string, std::string>;

// Returns the section of an INI file as AWS's tools write it; empty if there is none. Indented lines belong to nested
// settings, which have no meaning here.
Section ReadSection(const std::string& path, absl::string_view name) {
  Section section;
  std::ifstream file(path);
  bool inside = false;
  for (std::string text; std::getline(file, text);) {
    const absl::string_view line = absl::StripAsciiWhitespace(text);
    if (line.empty() || line[0] == '#' || line[0] == ';') continue;
    if (line[0] == '[') {
      inside = line.back() == ']' && absl::StripAsciiWhitespace(line.substr(1, line.size() - 2)) == name;
      if (inside) section.try_emplace("");  // the section is there
      continue;
    }
    const size_t equals = line.find('=');
    if (!inside || equals == absl::string_view::npos || absl::ascii_isspace(static_cast<unsigned char>(text[0])))
      continue;
    section[absl::AsciiStrToLower(absl::StripAsciiWhitespace(line.substr(0, equals)))] =
        std::string(absl::StripAsciiWhitespace(line.substr(equals + 1)));
  }
  return section;
}

std::string ValueOf(const Section& section, const char* key) {
  const auto found = section.find(key);
  return found == section.end() ? "" : found->second;
}

// Returns the first of the values that is not empty.
std::string First(std::initializer_list<std::string> values) {
  for (const std::string& value : values) {
    if (!value.empty()) return value;
  }
  return "";
}

bool SetCredentials(AwsSettings& settings, std::string key_id, std::string secret, std::string token) {
  if (key_id.empty() || secret.empty()) return false;
  settings.key_id = std::move(key_id);
  settings.secret = std::move(secret);
  settings.session_token = std::move(token);
  return true;
}

bool SetCredentials(AwsSettings& settings, const Section& section) {
  return SetCredentials(settings, ValueOf(section, "aws_access_key_id"), ValueOf(section, "aws_secret_access_key"),
                        ValueOf(section, "aws_session_token"));
}

}  // namespace

std::string ProcessVariable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

absl::StatusOr<int> ReadTries(const Environment& environment) {
  constexpr int kMost = 100;
  const std::string value = environment("AWS_MAX_ATTEMPTS");
  int tries = kStandardTries;
  if (value.empty() || (absl::SimpleAtoi(value, &tries) && tries >= 1 && tries <= kMost)) return tries;
  return absl::InvalidArgumentError(
      absl::StrCat("AWS_MAX_ATTEMPTS: \"", value, "\" is not a whole number from 1 to ", kMost));
}

absl::StatusOr<AwsSettings> ReadAwsSettings(const Environment& environment) {
  const std::string folder = environment("HOME") + "/.aws/";
  const std::string credentials_path = First({environment("AWS_SHARED_CREDENTIALS_FILE"), folder + "credentials"});
  const std::string config_path = First({environment("AWS_CONFIG_FILE"), folder + "config"});
  const std::string given = First({environment("AWS_PROFILE"), environment("AWS_DEFAULT_PROFILE")});
  const std::string profile = First({given, "default"});
  const Section credentials = ReadSection(credentials_path, profile);
  const Section config = ReadSection(config_path, profile == "default" ? profile : absl::StrCat("profile ", profile));
  AwsSettings settings;
  settings.region = First({environment("AWS_REGION"), environment("AWS_DEFAULT_REGION"), ValueOf(config, "region"),
                           std::string("us-east-1")});
  settings.endpoint = First({environment("AWS_ENDPOINT_URL_S3"), environment("AWS_ENDPOINT_URL"),
                             ValueOf(config, "endpoint_url"), ValueOf(credentials, "endpoint_url")});
  while (absl::EndsWith(settings.endpoint, "/")) settings.endpoint.pop_back();
  const std::string key_id = environment("AWS_ACCESS_KEY_ID"), secret = environment("AWS_SECRET_ACCESS_KEY");
  if (key_id.empty() != secret.empty()) {
    return absl::UnauthenticatedError(
        absl::StrCat(key_id.empty() ? "AWS_ACCESS_KEY_ID" : "AWS_SECRET_ACCESS_KEY", ": is not set, but ",
                     key_id.empty() ? "AWS_SECRET_ACCESS_KEY" : "AWS_ACCESS_KEY_ID", " is"));
  }
  if (SetCredentials(settings, key_id, secret, environment("AWS_SESSION_TOKEN"))) return settings;
  if (!given.empty() && credentials.empty() && config.empty()) {
    return absl::UnauthenticatedError(
        absl::StrCat("AWS_PROFILE: \"", given, "\" is neither in ", credentials_path, " nor in ", config_path));
  }
  if (SetCredentials(settings, credentials) || SetCredentials(settings, config)) return settings;
  return absl::UnauthenticatedError(
      absl::StrCat("no credentials of S3: AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY are "
                   "not set, and profile ",
                   profile, " has none in ", credentials_path, " and ", config_path));
}

}  // namespace latvox::client
