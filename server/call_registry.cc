#include "server/call_registry.h"

#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "server/errors.h"

namespace latvox {
namespace {

// Long enough for many jobs to end, short enough not to leave a free place unused.
constexpr absl::Duration kRetryDelay = absl::Seconds(1);

absl::Status Full(uint32_t max_jobs) {
  const std::string limit = absl::StrCat(max_jobs);
  return WithRetry(MakeError(absl::StatusCode::kResourceExhausted,
                             absl::StrCat("jobs: ", limit, " of ", limit, " are running; try again"),
                             {"TOO_MANY_JOBS", "jobs", limit, limit}),
                   kRetryDelay);
}

absl::Status Stopping() {
  return WithRetry(MakeError(absl::StatusCode::kUnavailable, "the server is stopping", {"SERVER_STOPPING", "", "", ""}),
                   kRetryDelay);
}

}  // namespace

absl::Status CallRegistry::Admit(std::shared_ptr<LiveCall> call) {
  const std::lock_guard lock(mu_);
  if (closed_) return Stopping();
  if (jobs_.size() >= max_jobs_) return Full(max_jobs_);
  const LiveCall* key = call.get();
  jobs_.insert(key);
  calls_.emplace(key, std::move(call));
  return absl::OkStatus();
}

void CallRegistry::Vacate(const LiveCall* call) {
  const std::lock_guard lock(mu_);
  jobs_.erase(call);
}

void CallRegistry::Remove(const LiveCall* call) {
  std::shared_ptr<LiveCall> removed;  // dies after the lock is released
  const std::lock_guard lock(mu_);
  const auto found = calls_.find(call);
  if (found == calls_.end()) return;
  removed = std::move(found->second);
  jobs_.erase(call);
  calls_.erase(found);
  if (calls_.empty()) empty_.notify_all();
}

void CallRegistry::Close() {
  const std::lock_guard lock(mu_);
  closed_ = true;
}

void CallRegistry::StopAll() {
  std::vector<std::shared_ptr<LiveCall>> calls;
  {
    const std::lock_guard lock(mu_);
    for (const auto& [key, call] : calls_) calls.push_back(call);
  }
  for (const auto& call : calls) call->Stop(Stopping());
}

bool CallRegistry::WaitUntilEmpty(absl::Duration timeout) {
  std::unique_lock lock(mu_);
  return empty_.wait_for(lock, absl::ToChronoNanoseconds(timeout), [this] { return calls_.empty(); });
}

size_t CallRegistry::size() const {
  const std::lock_guard lock(mu_);
  return calls_.size();
}

}  // namespace latvox
