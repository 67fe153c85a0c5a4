// How the tool ends: its exit status and its one line about an error.
#ifndef LATVOX_CLIENT_TOOL_CLI_EXIT_STATUS_H_
#define LATVOX_CLIENT_TOOL_CLI_EXIT_STATUS_H_

#include <string>

#include "absl/status/status.h"

namespace latvox::client {

// Scripts rely on these numbers.
enum class ExitStatus {
  kDone = 0,
  kOther = 1,  // and: the files of `latvox compare` differ
  kWrongUsage = 2,
  kBadInput = 3,
  kUnreachable = 4,
  kRefused = 5,    // by a limit or overload, or for want of a token
  kCancelled = 6,  // or timed out
};

ExitStatus ExitStatusOf(const absl::Status& status);

// The status's message on one line, without its end, with those of field, value, limit and time to try again that the
// message does not hold already.
std::string ErrorText(const absl::Status& status);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_EXIT_STATUS_H_
