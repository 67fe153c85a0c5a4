// Runs the jobs of a batch.
#ifndef LATVOX_CLIENT_TOOL_CLI_BATCH_RUN_H_
#define LATVOX_CLIENT_TOOL_CLI_BATCH_RUN_H_

#include <condition_variable>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "client/tool/cli/batch_options.h"
#include "client/tool/cli/batch_results.h"
#include "client/tool/cli/job_file.h"
#include "client/tool/cli/progress_bar.h"
#include "client/tool/cli/remote_files.h"
#include "client/tool/cli/report.h"
#include "client/tool/cli/session.h"
#include "latvox/cancellation.h"

namespace latvox::client {

// Call Run once. Memory: the need of BatchOptions.jobs jobs, and one line for each of the first failed jobs.
class BatchRun {
 public:
  // All arguments must outlive the object.
  BatchRun(const BatchOptions& options, const JobFile& file, const DoneJobs& done, ResultsFile& results,
           const Cancellation& cancellation);

  // Returns when every job has ended or the batch was cancelled. An error of the server or of the results file stops
  // the batch.
  absl::Status Run();

  // Call after Run. Returns the counts, the failures and the status.
  BatchReport report() const;

 private:
  using SharedSession = std::shared_ptr<const Session>;

  // Runs on each worker's thread.
  void Work();
  void Do(JobParser& parser, const JobLine& line, JobResult& result);
  void DoWithCopies(const Job& job, const CallOptions& call, RemoteFiles& files, JobResult& result);
  // Returns the digest of the voxels if the job is done.
  absl::StatusOr<std::optional<std::string>> FindDone(const Job& job, const std::string& digest, RemoteFiles& files);
  // Removes what killed batches left in the outputs' directories: once in each, because it may hold a million files.
  void RemoveAbandoned(const std::vector<std::string>& outputs);
  void Voxelize(const Job& job, const CallOptions& call, RemoteFiles& files, JobResult& result);
  absl::StatusOr<SharedSession> Connect();
  void Disconnect(const SharedSession& session);
  void End(const JobResult& result);
  void Count(const JobResult& result);

  // Runs on the thread of Run, because a private server lives as long as the thread that started it.
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
  // mutex_ guards all of these:
  ProgressBar bar_;
  size_t next_ = 0;        // next line to run
  int workers_ = 0;        // running
  bool wanted_ = false;    // a worker waits for a session
  SharedSession session_;  // null before the first one, and after its server was lost
  absl::Status stop_;      // not OK: the reason to begin no further job
  BatchReport report_;
  std::set<std::string> searched_;  // directories
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_BATCH_RUN_H_
