// A file of jobs, one per line. client/tool/cli/job_line.h describes a line.
#ifndef LATVOX_CLIENT_TOOL_CLI_JOB_FILE_H_
#define LATVOX_CLIENT_TOOL_CLI_JOB_FILE_H_

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/tool/cli/worker.h"
#include "latvox/cancellation.h"

namespace latvox::client {

struct JobLine {
  uint64_t number;  // counted from 1
  absl::string_view text;
};

// Jobs are kept as text and parsed again when their turn comes, because there may be millions.
struct JobFile {
  std::unique_ptr<const std::string> text;
  uint64_t jobs = 0;                // of all workers; blank lines do not count
  std::vector<JobLine> lines;       // of this worker, within text
  std::vector<std::string> errors;  // of the first wrong lines: "FILE:LINE: FIELD: ..."
  uint64_t wrong = 0;               // number of wrong lines, of all workers
};

// Reads the file, or standard input for "-". Checks the lines of all workers against the rules and against each other:
// outputs and ids must differ, and no output may be a mesh. Wrong lines are not an error of this function.
// Errors: those of ReadBytes; INVALID_ARGUMENT if there is no job at all; CANCELLED.
absl::StatusOr<JobFile> ReadJobFile(const std::string& path, const std::string& directory, const Worker& worker,
                                    const Cancellation& cancellation);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_JOB_FILE_H_
