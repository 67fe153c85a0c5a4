#include "client/tool/cli/batch_command.h"

#include <cstdio>
#include <filesystem>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "client/mesh_files/input.h"
#include "client/tool/cli/batch_results.h"
#include "client/tool/cli/batch_run.h"
#include "client/tool/cli/job_file.h"

namespace latvox::client {
namespace {

void Say(const std::string& line) { std::fprintf(stderr, "latvox: %s\n", line.c_str()); }

absl::StatusOr<JobFile> ReadJobs(const BatchOptions& options, const Cancellation& cancellation) {
  auto file = ReadJobFile(options.jobs_file, options.directory, options.worker.worker, cancellation);
  if (!file.ok() || file->wrong == 0) return file;
  for (const std::string& error : file->errors) Say(error);
  return absl::InvalidArgumentError(absl::StrCat(NameOfInput(options.jobs_file), ": ", file->wrong, " of ", file->jobs,
                                                 " jobs are wrong; no job was run"));
}

absl::Status MakeDirectory(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (!error) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat(path, ": cannot be created (", error.message(), ")"));
}

}  // namespace

absl::StatusOr<BatchReport> RunBatch(const BatchOptions& options, const Cancellation& cancellation) {
  const absl::Time start = absl::Now();
  const auto file = ReadJobs(options, cancellation);
  if (!file.ok()) return file.status();
  const auto& [worker, source] = options.worker;
  if (!source.empty()) {
    Say(absl::StrCat("worker ", worker.index, "/", worker.count, " (", source, "): ", file->lines.size(), " of ",
                     file->jobs, " jobs"));
  }
  if (auto status = MakeDirectory(options.directory); !status.ok()) return status;
  const std::string results = (std::filesystem::path(options.directory) / ResultsName(worker)).string();
  const auto results_file = ResultsFile::Open(results, cancellation, Say);
  if (!results_file.ok()) return results_file.status();
  // The results are read only after no other process writes to this worker's file.
  const auto done = options.resume ? DoneJobs::Read(options.directory, cancellation) : DoneJobs();
  if (!done.ok()) return done.status();
  BatchRun run(options, *file, *done, **results_file, cancellation);
  const absl::Status status = run.Run();
  BatchReport report = run.report();
  for (const std::string& line : report.failures) Say(line);
  if (const uint64_t more = report.failed - report.failures.size(); more > 0) {
    Say(absl::StrCat("and ", more, " more jobs failed; see ", results));
  }
  if (!status.ok()) return status;
  if (report.cancelled) Say("cancelled; run again with --resume to continue");
  report.results = results;
  report.total_ms = absl::ToDoubleMilliseconds(absl::Now() - start);
  return report;
}

}  // namespace latvox::client
