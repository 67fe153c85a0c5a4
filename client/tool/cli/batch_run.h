// The jobs of a batch at work.
#ifndef LATVOX_CLIENT_TOOL_CLI_BATCH_RUN_H_
#define LATVOX_CLIENT_TOOL_CLI_BATCH_RUN_H_

#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "client/tool/cli/batch_options.h"
#include "client/tool/cli/batch_results.h"
#include "client/tool/cli/job_file.h"
#include "client/tool/cli/progress_bar.h"
#include "client/tool/cli/report.h"
#include "client/tool/cli/session.h"
#include "latvox/cancellation.h"

namespace latvox::client {

// Run is called once. Memory: what BatchOptions.jobs jobs take, and a line for each of the first jobs that fail.
class BatchRun {
 public:
  // All must outlive it.
  BatchRun(const BatchOptions& options, const JobFile& file, const DoneJobs& done, ResultsFile& results,
           const Cancellation& cancellation);

  // Until every job has ended, or the batch was cancelled. Errors: no server, no results; then the batch has stopped.
  absl::Status Run();

  // Afterwards: the counts, the failures and the status.
  BatchReport report() const;

 private:
  using SharedSession = std::shared_ptr<const Session>;

  // On each worker's thread.
  void Work();
  void Do(JobParser& parser, const JobLine& line, JobResult& result);
  void Voxelize(const Job& job, const CallOptions& call, JobResult& result);
  absl::StatusOr<SharedSession> Connect();
  void Disconnect(const SharedSession& session);
  void End(const JobResult& result);
  void Count(const JobResult& result);

  // On the thread of Run: a private server lives as long as the thread that started it.
  void Watch();
  void OpenSession(std::unique_lock<std::mutex>& lock);
  void ShowProgress();

  const BatchOptions& options_;
  const JobFile& file_;
  const DoneJobs& done_;
  ResultsFile& results_;
  const Cancellation& cancellation_;
  const absl::Time start_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  // All guarded by mutex_:
  ProgressBar bar_;
  size_t next_ = 0;        // line to be taken
  int workers_ = 0;        // that are at work
  bool wanted_ = false;    // a session
  SharedSession session_;  // null: none yet, or its server was lost
  absl::Status stop_;      // not OK: why no further job is taken
  BatchReport report_;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_BATCH_RUN_H_
