// What became of the jobs of a batch: a file of JSON lines, which a later run can go on from.
#ifndef LATVOX_CLIENT_TOOL_CLI_BATCH_RESULTS_H_
#define LATVOX_CLIENT_TOOL_CLI_BATCH_RESULTS_H_

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "client/tool/cli/job_line.h"
#include "client/tool/cli/report.h"
#include "client/tool/cli/worker.h"
#include "latvox/cancellation.h"

namespace latvox::client {

// results.jsonl, or results-I-of-N.jsonl, so that no two workers write one file.
std::string ResultsName(const Worker& worker);

// Lines of `report.h`'s ToJsonLine, appended whole as jobs end. Threads: Append may be called at once.
class ResultsFile {
 public:
  static constexpr absl::Duration kLockLimit = absl::Minutes(2);

  // Makes the file if there is none. If another process has it open here, waits for its end, after a word about that,
  // until the limit: some file systems hold a dead machine's lock for a while. A last line that a killed run left
  // unfinished is removed. Errors: FAILED_PRECONDITION, with the path: it cannot be written, or is still in use;
  // CANCELLED.
  static absl::StatusOr<std::unique_ptr<ResultsFile>> Open(const std::string& path, const Cancellation& cancellation,
                                                           const std::function<void(const std::string&)>& say,
                                                           absl::Duration limit = kLockLimit);
  ~ResultsFile();
  ResultsFile(const ResultsFile&) = delete;
  ResultsFile& operator=(const ResultsFile&) = delete;

  const std::string& path() const { return path_; }
  absl::Status Append(const JobResult& result);

 private:
  ResultsFile(std::string path, int fd);
  absl::Status Error(const char* why) const;
  absl::Status Lock(const Cancellation& cancellation, const std::function<void(const std::string&)>& say,
                    absl::Duration limit) const;
  absl::Status RemoveUnfinishedLine() const;

  const std::string path_;
  const int fd_;
  std::mutex mutex_;
};

// Jobs that runs before this one have done.
class DoneJobs {
 public:
  DoneJobs() = default;

  // From all files of results in the directory, however many workers there were. Of several lines of a job the one that
  // ended last counts; those of versions that did not write when are the oldest. Lines that are none are ignored.
  // Errors: FAILED_PRECONDITION (a file cannot be read), CANCELLED.
  static absl::StatusOr<DoneJobs> Read(const std::string& directory, const Cancellation& cancellation);

  // The digest of the voxels if this very job is done: its digest is the same, its outputs are there and as long as
  // they were, and those that are .vdb hold these voxels.
  std::optional<std::string> Find(const Job& job, const std::string& job_digest) const;

 private:
  struct Done {
    uint64_t ended_unix_ms = 0;
    std::string job_digest, digest;
    std::vector<uint64_t> bytes;  // of the outputs; empty if the line says nothing of them
  };
  void Add(const std::string& name, Done done);
  absl::Status ReadFile(const std::string& path, const Cancellation& cancellation);

  absl::flat_hash_map<std::string, Done> done_;  // by the first output's name
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_BATCH_RESULTS_H_
