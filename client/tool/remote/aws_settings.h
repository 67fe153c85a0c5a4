// Credentials, region and endpoint of S3, from the places where AWS's tools look for them.
#ifndef LATVOX_CLIENT_TOOL_REMOTE_AWS_SETTINGS_H_
#define LATVOX_CLIENT_TOOL_REMOTE_AWS_SETTINGS_H_

#include <functional>
#include <string>

#include "absl/status/statusor.h"

namespace latvox::client {

struct AwsSettings {
  std::string key_id, secret, session_token;  // the token may be empty
  std::string region;
  std::string endpoint;  // URL without a slash at its end; empty: AWS's own
};

// Returns the value of a variable, or "".
using Environment = std::function<std::string(const char*)>;

// Returns the value that this process has.
std::string ProcessVariable(const char* name);

// Returns how often a call is tried: AWS_MAX_ATTEMPTS, or the standard. Errors: INVALID_ARGUMENT: not from 1 to 100.
inline constexpr int kStandardTries = 8;
absl::StatusOr<int> ReadTries(const Environment& environment);

// Returns the settings; the first place that has one counts:
//   credentials   AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY and AWS_SESSION_TOKEN; then the profile in
//                 ~/.aws/credentials, then in ~/.aws/config
//   region        AWS_REGION; AWS_DEFAULT_REGION; the profile's region; us-east-1
//   endpoint      AWS_ENDPOINT_URL_S3; AWS_ENDPOINT_URL; the profile's endpoint_url
// The profile is AWS_PROFILE, AWS_DEFAULT_PROFILE or default. AWS_SHARED_CREDENTIALS_FILE and AWS_CONFIG_FILE name
// other files. Neither roles of machines nor single sign-on are asked for. Errors: UNAUTHENTICATED, naming the places:
// there are no credentials, or half of them; the profile does not exist. No error has a value of a credential in it.
absl::StatusOr<AwsSettings> ReadAwsSettings(const Environment& environment);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_REMOTE_AWS_SETTINGS_H_
