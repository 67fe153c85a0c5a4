#include "client/tool/cli/batch_results.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/synchronization/notification.h"
#include "absl/time/clock.h"
#include "client/json/json.h"
#include "latvox/grid/voxel_grid.h"

namespace latvox::client {
namespace {

constexpr absl::Duration kLockPoll = absl::Seconds(1);

bool IsResultsName(const std::string& name) {
  return name == "results.jsonl" || (absl::StartsWith(name, "results-") && absl::EndsWith(name, ".jsonl"));
}

// Throws SortedJson::exception if the value is not an unsigned number.
uint64_t WholeNumber(const SortedJson& number) {
  return number.get_ref<const SortedJson::number_unsigned_t&>();  // get() would convert numbers outside its range
}

}  // namespace

std::string ResultsName(const Worker& worker) {
  if (worker.count == 1) return "results.jsonl";
  return absl::StrCat("results-", worker.index, "-of-", worker.count, ".jsonl");
}

ResultsFile::ResultsFile(std::string path, int fd) : path_(std::move(path)), fd_(fd) {}
ResultsFile::~ResultsFile() { close(fd_); }

absl::Status ResultsFile::Error(const char* why) const {
  return absl::FailedPreconditionError(absl::StrCat(path_, ": cannot be written (", why, ")"));
}

absl::StatusOr<std::unique_ptr<ResultsFile>> ResultsFile::Open(const std::string& path,
                                                               const Cancellation& cancellation,
                                                               const std::function<void(const std::string&)>& say,
                                                               absl::Duration limit) {
  const int fd = open(path.c_str(), O_CREAT | O_RDWR | O_APPEND | O_CLOEXEC, 0666);
  const int error_number = errno;
  std::unique_ptr<ResultsFile> file(new ResultsFile(path, fd));
  if (fd < 0) return file->Error(std::strerror(error_number));
  if (auto status = file->Lock(cancellation, say, limit); !status.ok()) return status;
  if (auto status = file->RemoveUnfinishedLine(); !status.ok()) return status;
  return file;
}

absl::Status ResultsFile::Lock(const Cancellation& cancellation, const std::function<void(const std::string&)>& say,
                               absl::Duration limit) const {
  absl::Notification cancelled;
  const Cancellation::Subscription on_cancel(cancellation, [&cancelled] { cancelled.Notify(); });
  const absl::Time give_up = absl::Now() + limit;
  bool said = false;
  // File systems without locks cannot be checked.
  while (flock(fd_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    const absl::Duration left = give_up - absl::Now();
    if (left <= absl::ZeroDuration()) return Error("another latvox batch is using it");
    if (!std::exchange(said, true)) {
      say(absl::StrCat(path_, ": another latvox batch is using it, or left its lock behind; waiting for up to ",
                       absl::FormatDuration(limit)));
    }
    if (cancelled.WaitForNotificationWithTimeout(std::min(left, kLockPoll))) return absl::CancelledError("cancelled");
  }
  return absl::OkStatus();
}

absl::Status ResultsFile::RemoveUnfinishedLine() const {
  off_t end = lseek(fd_, 0, SEEK_END);
  const off_t size = end;
  char byte = 0;
  while (end > 0 && pread(fd_, &byte, 1, end - 1) == 1 && byte != '\n') --end;
  if (end < 0 || (end < size && ftruncate(fd_, end) != 0)) return Error(std::strerror(errno));
  return absl::OkStatus();
}

// A single write makes the line appear whole. After a kill it is at worst the unfinished last line.
absl::Status ResultsFile::Append(const JobResult& result) {
  const std::string line = ToJsonLine(result) + "\n";
  const std::lock_guard lock(mutex_);
  for (size_t written = 0; written < line.size();) {
    const ssize_t n = write(fd_, line.data() + written, line.size() - written);
    if (n < 0 && errno != EINTR) return Error(std::strerror(errno));
    if (n > 0) written += static_cast<size_t>(n);
  }
  return absl::OkStatus();
}

absl::StatusOr<DoneJobs> DoneJobs::Read(const std::string& directory, const Cancellation& cancellation) {
  DoneJobs jobs;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(directory, error)) {
    if (!IsResultsName(entry.path().filename().string())) continue;
    if (auto status = jobs.ReadFile(entry.path().string(), cancellation); !status.ok()) return status;
  }
  if (error) return absl::FailedPreconditionError(absl::StrCat(directory, ": cannot be read (", error.message(), ")"));
  return jobs;
}

absl::Status DoneJobs::ReadFile(const std::string& path, const Cancellation& cancellation) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (cancellation.cancelled()) return absl::CancelledError("cancelled");
    const auto json = SortedJson::parse(line, nullptr, /*allow_exceptions=*/false);
    if (!json.is_object() || json.value("/status"_json_pointer, SortedJson()) != "done") continue;
    try {
      Done done;
      done.job_digest = json.at("job_digest").get<std::string>();
      done.digest = json.at("summary").at("digest").get<std::string>();
      if (json.contains("ended_unix_ms")) done.ended_unix_ms = WholeNumber(json["ended_unix_ms"]);
      if (json.contains("output_bytes")) {
        for (const auto& bytes : json["output_bytes"].get_ref<const SortedJson::array_t&>())
          done.bytes.push_back(WholeNumber(bytes));
      }
      Add(json.at("outputs").at(0).get<std::string>(), std::move(done));
    } catch (const SortedJson::exception&) {
      // A line of another program, or of another version: its job runs again.
    }
  }
  if (!file.eof()) return absl::FailedPreconditionError(absl::StrCat(path, ": cannot be read to its end"));
  return absl::OkStatus();
}

void DoneJobs::Add(const std::string& name, Done done) {
  Done& newest = done_[name];
  if (done.ended_unix_ms >= newest.ended_unix_ms) newest = std::move(done);
}

std::optional<std::string> DoneJobs::Find(const Job& job, const std::string& job_digest,
                                          const IsMissing& is_missing) const {
  const auto done = done_.find(job.names.front());
  if (done == done_.end() || done->second.job_digest != job_digest) return std::nullopt;
  const std::vector<uint64_t>& bytes = done->second.bytes;
  for (size_t n = 0; n < job.options.outputs.size(); ++n) {
    const std::string& output = job.options.outputs[n];
    if (job.options.remote.objects.contains(output)) {
      if (n >= bytes.size() || is_missing(output, bytes[n])) return std::nullopt;
      continue;
    }
    std::error_code error;
    if (!std::filesystem::is_regular_file(output, error)) return std::nullopt;
    if (!bytes.empty() && (n >= bytes.size() || std::filesystem::file_size(output, error) != bytes[n] || error)) {
      return std::nullopt;
    }
    if (absl::AsciiStrToLower(std::filesystem::path(output).extension().string()) != ".vdb") continue;
    const auto digest = ReadGridFileDigest(output);
    if (!digest.ok() || *digest != done->second.digest) return std::nullopt;
  }
  return done->second.digest;
}

}  // namespace latvox::client
