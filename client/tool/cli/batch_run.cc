#include "client/tool/cli/batch_run.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <filesystem>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/time/clock.h"
#include "client/mesh_files/input.h"
#include "client/tool/cli/abandoned_work.h"
#include "client/tool/cli/job_digest.h"
#include "client/tool/cli/voxelize_command.h"
#include "client/tool/output/temporary_name.h"
#include "client/tool/remote/remote_name.h"
#include "deploy/process/exhaustion.h"
#include "latvox/error.h"

namespace latvox::client {
namespace {

constexpr size_t kFailuresKept = 100;
constexpr auto kGlance = std::chrono::milliseconds(100);

// A job may name directories below that of the batch.
absl::Status MakeDirectories(const std::vector<std::string>& outputs) {
  for (const std::string& output : outputs) {
    if (IsRemote(output)) continue;
    std::error_code error;
    std::filesystem::create_directories(std::filesystem::path(output).parent_path(), error);
    if (!error) continue;
    return absl::FailedPreconditionError(absl::StrCat(output, ": cannot be written (", error.message(), ")"));
  }
  return absl::OkStatus();
}

// A later run recognizes unchanged outputs by these lengths.
void Measure(const std::vector<std::string>& outputs, const RemoteFiles& files, JobResult& result) {
  for (const std::string& output : outputs) {
    if (IsRemote(output)) {
      result.bytes.push_back(files.BytesOf(output));
      continue;
    }
    std::error_code error;
    result.bytes.push_back(std::filesystem::file_size(output, error));
    if (!error) continue;
    result.outcome = JobResult::Outcome::kFailed;
    result.error =
        absl::FailedPreconditionError(absl::StrCat(output, ": was written but has disappeared: ", error.message()));
    return;
  }
}

}  // namespace

BatchRun::BatchRun(const BatchOptions& options, const JobFile& file, const DoneJobs& done, ResultsFile& results,
                   const Cancellation& cancellation)
    : options_(options), file_(file), done_(done), results_(results), cancellation_(cancellation), start_(absl::Now()) {
  report_.jobs = file.lines.size();
}

absl::Status BatchRun::Run() {
  std::vector<std::thread> threads;
  workers_ = static_cast<int>(std::min<size_t>(file_.lines.size(), static_cast<size_t>(options_.jobs)));
  for (int n = 0, count = workers_; n < count; ++n) threads.emplace_back([this] { Work(); });
  Watch();
  for (std::thread& thread : threads) thread.join();
  session_.reset();
  return absl::IsCancelled(stop_) ? absl::OkStatus() : stop_;
}

BatchReport BatchRun::report() const {
  BatchReport report = report_;
  report.cancelled = cancellation_.cancelled() && report.done + report.failed + report.skipped < report.jobs;
  if (report.cancelled) report.status = ExitStatus::kCancelled;
  return report;
}

void BatchRun::Work() {
  JobParser parser(std::filesystem::path(options_.jobs_file).parent_path().string(), options_.directory);
  for (;;) {
    const JobLine* line = nullptr;
    {
      const std::lock_guard lock(mutex_);
      if (!stop_.ok() || cancellation_.cancelled() || next_ == file_.lines.size()) break;
      line = &file_.lines[next_++];
    }
    JobResult result;
    result.line = line->number;
    try {
      Do(parser, *line, result);
    } catch (const std::exception& error) {
      result.error = StatusOf(error);
    }
    const bool names_option = absl::StartsWith(GetErrorDetails(result.error).field, "--");
    if (absl::IsInvalidArgument(result.error) || names_option) result.error = parser.WithFields(result.error);
    if (!result.error.ok()) result.outcome = JobResult::Outcome::kFailed;
    result.ended_unix_ms = static_cast<uint64_t>(absl::ToUnixMillis(absl::Now()));
    End(result);
  }
  const std::lock_guard lock(mutex_);
  --workers_;
  changed_.notify_all();
}

void BatchRun::Do(JobParser& parser, const JobLine& line, JobResult& result) {
  auto job = parser.Parse(line.text);
  result.error = job.status();
  if (!job.ok()) return;
  job->options.remote.allow_http = options_.allow_http;
  const CallOptions call = MakeCallOptions(options_.server, cancellation_);
  result.id = job->id;
  result.mesh = job->mesh;
  result.outputs = job->names;
  result.error = CheckPlaces(*job);
  if (result.error.ok()) result.error = Align(job->options, cancellation_);
  if (!result.error.ok()) return;
  RemoveAbandoned(job->options.outputs);
  const auto files = RemoteFiles::Fetch(job->options, call);
  result.error = files.status();
  if (files.ok()) DoWithCopies(*job, call, **files, result);
}

void BatchRun::DoWithCopies(const Job& job, const CallOptions& call, RemoteFiles& files, JobResult& result) {
  Job local = job;
  local.options = files.local();
  // Computed before the mesh is read for sending: if the mesh changes in between, the next run repeats the job.
  auto digest = DoAbandonably([local] { return JobDigest(local); }, call);
  result.error = files.Named(digest.status());
  if (!digest.ok()) return;
  result.job_digest = *std::move(digest);
  auto voxels = FindDone(job, result.job_digest, files);
  result.error = files.Named(voxels.status());
  if (!voxels.ok()) return;
  if (*voxels) {
    result.outcome = JobResult::Outcome::kSkipped;
    result.digest = **std::move(voxels);
  } else {
    Voxelize(local, call, files, result);
  }
  if (result.outcome != JobResult::Outcome::kFailed) Measure(job.options.outputs, files, result);
}

absl::StatusOr<std::optional<std::string>> BatchRun::FindDone(const Job& job, const std::string& digest,
                                                              RemoteFiles& files) {
  if (!options_.resume) return std::nullopt;
  auto in_store = files.FindDone(digest);
  if (!in_store.ok() || *in_store) return in_store;
  absl::Status status;
  auto in_results = done_.Find(job, digest, [&](const std::string& output, uint64_t bytes) {
    const auto is_missing = files.IsMissing(output, digest, bytes);
    status.Update(is_missing.status());
    return !is_missing.ok() || *is_missing;
  });
  if (!status.ok()) return status;
  return in_results;
}

void BatchRun::RemoveAbandoned(const std::vector<std::string>& outputs) {
  for (const std::string& output : outputs) {
    if (IsRemote(output)) continue;
    const std::string directory = std::filesystem::path(output).parent_path().string();
    {
      const std::lock_guard lock(mutex_);
      if (!searched_.insert(directory).second) continue;
    }
    RemoveAbandonedFiles(directory);
  }
}

void BatchRun::Voxelize(const Job& job, const CallOptions& call, RemoteFiles& files, JobResult& result) {
  result.error = MakeDirectories(job.options.outputs);
  if (!result.error.ok()) return;
  SharedSession session;
  JobHooks hooks;
  hooks.connect = [&]() -> absl::StatusOr<const Client*> {
    auto connected = Connect();
    if (!connected.ok()) return connected.status();
    session = *std::move(connected);
    return &session->client();
  };
  hooks.on_stage = [](const std::string&) {};
  hooks.on_progress = [](double, uint64_t) {};
  hooks.say = [&](const std::string& line) {
    const std::lock_guard lock(mutex_);
    bar_.Say(absl::StrCat("latvox: ", job.id, ": ", line));
  };
  files.SetJobDigest(result.job_digest);
  files.Hook(hooks);
  auto report = RunJob(job.options, call, hooks);
  if (report.ok()) {
    result.outcome = JobResult::Outcome::kDone;
    files.Name(*report);
    result.report = *std::move(report);
    return;
  }
  result.error = files.Named(report.status());
  if (session != nullptr && absl::IsUnavailable(result.error)) Disconnect(session);
}

absl::StatusOr<BatchRun::SharedSession> BatchRun::Connect() {
  std::unique_lock lock(mutex_);
  wanted_ = true;
  changed_.notify_all();
  changed_.wait(lock, [this] { return session_ != nullptr || !stop_.ok(); });
  if (session_ == nullptr) return stop_;
  return session_;
}

// A lost private server does not come back: the next job starts another one.
void BatchRun::Disconnect(const SharedSession& session) {
  if (!options_.server.address.empty()) return;
  const std::lock_guard lock(mutex_);
  if (session_ == session) session_ = nullptr;
}

// A failure caused by stopping the batch does not count as a failure of the job.
void BatchRun::End(const JobResult& result) {
  const bool failed = result.outcome == JobResult::Outcome::kFailed;
  std::unique_lock lock(mutex_);
  if (failed && (cancellation_.cancelled() || !stop_.ok())) return;
  lock.unlock();
  const absl::Status written = results_.Append(result);
  lock.lock();
  if (stop_.ok()) stop_ = written;
  Count(result);
}

void BatchRun::Count(const JobResult& result) {
  using Outcome = JobResult::Outcome;
  report_.done += result.outcome == Outcome::kDone;
  report_.skipped += result.outcome == Outcome::kSkipped;
  if (result.outcome != Outcome::kFailed) return;
  const ExitStatus status = ExitStatusOf(result.error);
  report_.status = report_.failed == 0 || report_.status == status ? status : ExitStatus::kOther;
  ++report_.failed;
  if (report_.failures.size() == kFailuresKept) return;
  report_.failures.push_back(
      absl::StrCat(NameOfInput(options_.jobs_file), ":", result.line, ": ", ErrorText(result.error)));
}

void BatchRun::Watch() {
  std::unique_lock lock(mutex_);
  while (workers_ > 0) {
    if (wanted_ && session_ == nullptr && stop_.ok()) OpenSession(lock);
    ShowProgress();
    changed_.wait_for(lock, kGlance);
  }
}

void BatchRun::OpenSession(std::unique_lock<std::mutex>& lock) {
  lock.unlock();
  CallOptions call;
  call.cancellation = cancellation_;
  auto session = Session::Open(options_.server, call);
  lock.lock();
  if (session.ok()) {
    session_ = std::make_shared<const Session>(*std::move(session));
  } else {
    stop_ = session.status();
  }
  wanted_ = false;
  changed_.notify_all();
}

void BatchRun::ShowProgress() {
  const uint64_t worked = report_.done + report_.failed, ended = worked + report_.skipped;
  const double seconds = absl::ToDoubleSeconds(absl::Now() - start_);
  std::string text = absl::StrCat(ended, "/", report_.jobs, " jobs");
  if (report_.failed > 0) absl::StrAppend(&text, ", ", report_.failed, " failed");
  if (worked > 0) {
    const double rate = static_cast<double>(worked) / seconds;
    const absl::Duration left = absl::Seconds(static_cast<double>(report_.jobs - ended) / rate);
    absl::StrAppendFormat(&text, ", %.3g/s, %s left", rate, absl::FormatDuration(absl::Trunc(left, absl::Seconds(1))));
  }
  bar_.Show(static_cast<double>(ended) / static_cast<double>(report_.jobs), text);
}

}  // namespace latvox::client
