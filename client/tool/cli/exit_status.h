// The exit status of the tool and its line about an error.
#ifndef LATVOX_CLIENT_TOOL_CLI_EXIT_STATUS_H_
#define LATVOX_CLIENT_TOOL_CLI_EXIT_STATUS_H_

#include <string>

#include "absl/status/status.h"

namespace latvox::client {

// Scripts rely on these numbers.
enum class ExitStatus {
  kDone = 0,
  kOther = 1,  // also: the files of `latvox compare` differ
  kWrongUsage = 2,
  kBadInput = 3,
  kUnreachable = 4,
  kRefused = 5,    // by a limit, by overload, without a valid token, or by the system: no memory, no thread
  kCancelled = 6,  // or timed out
};

ExitStatus ExitStatusOf(const absl::Status& status);

// Returns the message of the status in one printable line, without a line end. Appends field, value, limit and retry
// delay if the message does not contain them.
std::string ErrorText(const absl::Status& status);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_EXIT_STATUS_H_
