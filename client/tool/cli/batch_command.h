// `latvox batch`.
#ifndef LATVOX_CLIENT_TOOL_CLI_BATCH_COMMAND_H_
#define LATVOX_CLIENT_TOOL_CLI_BATCH_COMMAND_H_

#include "absl/status/statusor.h"
#include "client/tool/cli/batch_options.h"
#include "client/tool/cli/report.h"
#include "latvox/cancellation.h"

namespace latvox::client {

// Does this worker's jobs; one that fails does not stop the others. What became of each is appended to the file of
// results as it ends, and of those that failed there is a line on standard error in the end. A cancelled batch leaves
// out the jobs that it cut off, which have left nothing.
// Errors: lines that are wrong, each of which is told on standard error, and then no job is run; results that cannot
// be written; a server that cannot be reached or started.
absl::StatusOr<BatchReport> RunBatch(const BatchOptions& options, const Cancellation& cancellation);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_BATCH_COMMAND_H_
