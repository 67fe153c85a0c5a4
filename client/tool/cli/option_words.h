// Errors of servers in the words of the tool.
#ifndef LATVOX_CLIENT_TOOL_CLI_OPTION_WORDS_H_
#define LATVOX_CLIENT_TOOL_CLI_OPTION_WORDS_H_

#include "absl/status/status.h"
#include "latvox/types.h"

namespace latvox::client {

// Returns the error with options in place of the request's fields, in its text and in its details: "--set interior"
// for "solid.surface none". Batches and Python replace options by their own names.
absl::Status WithOptions(const absl::Status& error, const VoxelizeRequest& request);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_OPTION_WORDS_H_
