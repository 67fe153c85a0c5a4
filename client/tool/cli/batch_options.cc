#include "client/tool/cli/batch_options.h"

#include <CLI/CLI.hpp>

#include "absl/strings/str_cat.h"
#include "client/tool/cli/common_options.h"

namespace latvox::client {
namespace {

constexpr int kMaxJobs = 256;

}  // namespace

void AddBatchOptions(CLI::App& command, BatchWords& words) {
  BatchOptions& options = words.options;
  command
      .add_option("jobs-file", options.jobs_file,
                  "a job a line, as a JSON object, or - for standard input; see README.md, \"Many meshes\"")
      ->type_name("JOBS.jsonl")
      ->required();
  command.add_option("-o,--out", options.directory, "directory of outputs and results; made if there is none")
      ->type_name("DIR")
      ->required();
  command
      .add_option("--worker", words.worker,
                  "only every Nth job from job I on, 0 <= I < N (default: what Kubernetes or Slurm says)")
      ->type_name("I/N")
      ->check(CheckShard);
  command.add_flag("--resume", options.resume, "skip jobs that are done");
  command
      .add_option("--jobs", options.jobs,
                  absl::StrCat("jobs at once (default: ", kPrivateJobs, "; with --server ", kServerJobs, ")"))
      ->type_name("P")
      ->check(Whole(1, kMaxJobs));
  command.add_flag("--json", options.json, "machine-readable summary on standard output");
  AddServerOptions(command, options.server);
}

BatchOptions Interpret(const BatchWords& words) {
  BatchOptions options = words.options;
  options.worker = ChooseWorker(words.worker);
  if (options.jobs == 0) options.jobs = options.server.address.empty() ? kPrivateJobs : kServerJobs;
  return options;
}

}  // namespace latvox::client
