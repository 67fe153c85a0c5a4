// A file of jobs, one a line; client/tool/cli/job_line.h says what a line is.
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
  uint64_t number;  // from 1 on, as editors count
  absl::string_view text;
};

// Millions of jobs are kept as the text they are, and parsed again when their turn comes.
struct JobFile {
  std::unique_ptr<const std::string> text;
  uint64_t jobs = 0;                // of all workers; lines of white space do not count
  std::vector<JobLine> lines;       // of this worker, within text
  std::vector<std::string> errors;  // of the first lines that are wrong: "FILE:LINE: FIELD: ..."
  uint64_t wrong = 0;               // lines, of all workers
};

// Reads the file, or standard input, "-", and holds every line of it, whosever it is, against the rules, and against
// each other: outputs and ids must differ, and no output may take the place of a mesh. Errors: those of ReadBytes;
// INVALID_ARGUMENT if there is no job at all; CANCELLED. Lines that are wrong are none.
absl::StatusOr<JobFile> ReadJobFile(const std::string& path, const std::string& directory, const Worker& worker,
                                    const Cancellation& cancellation);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_JOB_FILE_H_
