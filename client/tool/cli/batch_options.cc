#include "client/tool/cli/batch_options.h"

#include "absl/strings/str_cat.h"
#include "client/tool/cli/common_options.h"
#include "client/tool/remote/remote_name.h"

namespace latvox::client {
namespace {

constexpr int kMaxJobs = 256;

}  // namespace

void AddBatchOptions(CommandParser& command, BatchWords& words) {
  BatchOptions& options = words.options;
  command.Add(
      {{.names = "jobs-file",
        .target = &options.jobs_file,
        .help = "File with one job per line as a JSON object, or - for standard input; see client/docs/batch.md",
        .value = "JOBS.jsonl",
        .required = true},
       {.names = "-o,--out",
        .target = &options.directory,
        .help = "Directory of outputs and results; created if it does not exist",
        .value = "DIR",
        .required = true},
       {.names = "--worker",
        .target = &words.worker,
        .help = "Run only every Nth job from job I on, 0 <= I < N",
        .value = "I/N",
        .checks = {{CheckShard}},
        .standard = "from Kubernetes or Slurm"},
       {.names = "--resume", .target = &options.resume, .help = "Skip jobs that are done"},
       {.names = "--jobs",
        .target = &options.jobs,
        .help = "Number of jobs at once",
        .value = "N",
        .checks = {Whole(1, kMaxJobs)},
        .standard = absl::StrCat(kPrivateJobs, ", or ", kServerJobs, " with --server")},
       AllowHttpRow(options.allow_http),
       JsonRow("Print the summary as JSON", options.json)});
  AddServerOptions(command, options.server);
}

BatchOptions Interpret(const BatchWords& words) {
  BatchOptions options = words.options;
  if (IsRemote(options.directory)) {
    Refuse("--out: \"", Redact(options.directory),
           "\" is not a directory of this machine, which results need; out of a ", "job may be a URL");
  }
  options.worker = ChooseWorker(words.worker);
  if (options.jobs == 0) options.jobs = options.server.address.empty() ? kPrivateJobs : kServerJobs;
  return options;
}

}  // namespace latvox::client
