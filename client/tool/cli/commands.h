// The small commands: `latvox info`, `latvox health`, `latvox limits`.
#ifndef LATVOX_CLIENT_TOOL_CLI_COMMANDS_H_
#define LATVOX_CLIENT_TOOL_CLI_COMMANDS_H_

#include <string>

#include "absl/status/statusor.h"
#include "client/tool/cli/session.h"
#include "latvox/cancellation.h"

namespace latvox::client {

// Each returns the text for standard output.
absl::StatusOr<std::string> RunInfo(const std::string& path, bool json);

// Errors: UNAVAILABLE if the server answers that it accepts no requests.
absl::StatusOr<std::string> RunHealth(const ServerChoice& choice, const Cancellation& cancellation);

absl::StatusOr<std::string> RunLimits(const ServerChoice& choice, bool json, const Cancellation& cancellation);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_COMMANDS_H_
