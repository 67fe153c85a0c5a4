// `latvox batch`.
#ifndef LATVOX_CLIENT_TOOL_CLI_BATCH_COMMAND_H_
#define LATVOX_CLIENT_TOOL_CLI_BATCH_COMMAND_H_

#include "absl/status/statusor.h"
#include "client/tool/cli/batch_options.h"
#include "client/tool/cli/report.h"
#include "latvox/cancellation.h"

namespace latvox::client {

// Runs the jobs of this worker. A failed job does not stop the others. Appends the outcome of each job to the results
// file as the job ends. At the end prints one line on standard error for each failed job. A cancelled batch omits the
// jobs that it interrupted, which leave no files.
// Errors: wrong lines (each is printed on standard error, and no job runs); results that cannot be written; a server
// that cannot be reached or started.
absl::StatusOr<BatchReport> RunBatch(const BatchOptions& options, const Cancellation& cancellation);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_BATCH_COMMAND_H_
