#include "client/tool/cli/batch_options.h"

#include "absl/strings/str_cat.h"
#include "client/tool/cli/common_options.h"

namespace latvox::client {
namespace {

constexpr int kMaxJobs = 256;

}  // namespace

void AddBatchOptions(CommandParser& command, BatchWords& words) {
  BatchOptions& options = words.options;
  command.Add({{.names = "jobs-file",
                .target = &options.jobs_file,
                .help = "a job a line, as a JSON object, or - for standard input; see client/docs/batch.md",
                .value = "JOBS.jsonl",
                .required = true},
               {.names = "-o,--out",
                .target = &options.directory,
                .help = "directory of outputs and results; made if there is none",
                .value = "DIR",
                .required = true},
               {.names = "--worker",
                .target = &words.worker,
                .help = "only every Nth job from job I on, 0 <= I < N (default: what Kubernetes or Slurm says)",
                .value = "I/N",
                .checks = {{CheckShard}}},
               {.names = "--resume", .target = &options.resume, .help = "skip jobs that are done"},
               {.names = "--jobs",
                .target = &options.jobs,
                .help = absl::StrCat("jobs at once (default: ", kPrivateJobs, "; with --server ", kServerJobs, ")"),
                .value = "P",
                .checks = {Whole(1, kMaxJobs)}},
               JsonRow("machine-readable summary on standard output", options.json)});
  AddServerOptions(command, options.server);
}

BatchOptions Interpret(const BatchWords& words) {
  BatchOptions options = words.options;
  options.worker = ChooseWorker(words.worker);
  if (options.jobs == 0) options.jobs = options.server.address.empty() ? kPrivateJobs : kServerJobs;
  return options;
}

}  // namespace latvox::client
