// Outcomes of the jobs of a batch: a file of JSON lines, from which a later run can resume.
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

// Returns results.jsonl, or results-I-of-N.jsonl, so that no two workers write one file.
std::string ResultsName(const Worker& worker);

// Appends lines of ToJsonLine (report.h), each whole, as jobs end. Append is thread-safe.
class ResultsFile {
 public:
  static constexpr absl::Duration kLockLimit = absl::Minutes(2);

  // Opens the file, and creates it if it does not exist. If another process has it open here, prints a line and waits
  // for it up to the limit. Some file systems keep the lock of a dead machine for a while. Removes an unfinished last
  // line of a killed run.
  // Errors: FAILED_PRECONDITION, with the path: it cannot be written, or is still in use; CANCELLED.
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

// Jobs that earlier runs have done.
class DoneJobs {
 public:
  DoneJobs() = default;

  // Reads all results files in the directory, of any number of workers. If several lines describe one job, the one that
  // ended last counts. Lines without a time, from older versions, count as oldest. Lines in another format are ignored.
  // Errors: FAILED_PRECONDITION (a file cannot be read), CANCELLED.
  static absl::StatusOr<DoneJobs> Read(const std::string& directory, const Cancellation& cancellation);

  // Returns whether a remote output is missing, or differs from the one with this length.
  using IsMissing = std::function<bool(const std::string& output, uint64_t bytes)>;

  // Returns the digest of the voxels if this very job is done. Then its job digest is equal, its outputs exist with
  // their recorded lengths, and each local .vdb output holds these voxels. Otherwise returns nothing.
  //   is_missing   not null if the job has remote outputs
  std::optional<std::string> Find(const Job& job, const std::string& job_digest,
                                  const IsMissing& is_missing = nullptr) const;

 private:
  struct Done {
    uint64_t ended_unix_ms = 0;
    std::string job_digest, digest;
    std::vector<uint64_t> bytes;  // of the outputs; empty if the line has none
  };
  void Add(const std::string& name, Done done);
  absl::Status ReadFile(const std::string& path, const Cancellation& cancellation);

  absl::flat_hash_map<std::string, Done> done_;  // keyed by the first output's name
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_BATCH_RESULTS_H_
