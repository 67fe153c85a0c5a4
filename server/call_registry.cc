#include "server/call_registry.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/errors.h"

namespace latvox {
namespace {

// Long enough for many jobs to end, short enough not to leave a free place unused.
constexpr absl::Duration kRetryDelay = absl::Seconds(1);

absl::Status TooMany(absl::string_view what, absl::string_view reason, uint32_t limit) {
  return WithRetry(MakeError(absl::StatusCode::kResourceExhausted,
                             absl::StrCat(what, ": ", limit, " of ", limit, " are in progress; try again"),
                             {std::string{reason}, std::string{what}, absl::StrCat(limit), absl::StrCat(limit)}),
                   kRetryDelay);
}

absl::Status Stopping() {
  return WithRetry(MakeError(absl::StatusCode::kUnavailable, "the server is stopping", {"SERVER_STOPPING", "", "", ""}),
                   kRetryDelay);
}

}  // namespace

absl::Status CallRegistry::CheckRoom(const std::string& client, uint32_t max_jobs_of_client) const {
  if (closed_) return Stopping();
  const uint32_t limit = limits_.max_jobs + limits_.max_queued_jobs;
  if (working_ + queued_ >= limit) return TooMany("jobs", "TOO_MANY_JOBS", limit);
  const uint32_t share =
      max_jobs_of_client == 0 ? limits_.max_jobs_per_client : std::min(max_jobs_of_client, limits_.max_jobs_per_client);
  const auto found = clients_.find(client);
  if (found != clients_.end() && found->second.jobs >= share) {
    return TooMany("jobs_of_client", "TOO_MANY_JOBS_OF_CLIENT", share);
  }
  return absl::OkStatus();
}

absl::Status CallRegistry::Admit(std::shared_ptr<LiveCall> call, const std::string& client,
                                 uint32_t max_jobs_of_client) {
  const std::lock_guard lock(mu_);
  if (absl::Status status = CheckRoom(client, max_jobs_of_client); !status.ok()) return status;
  const LiveCall* key = call.get();
  calls_.emplace(key, Entry{std::move(call), client});
  ++clients_[client].jobs;
  ++queued_;
  return absl::OkStatus();
}

void CallRegistry::AwaitTurn(const LiveCall* call) {
  {
    const std::lock_guard lock(mu_);
    const auto found = calls_.find(call);
    if (found == calls_.end() || found->second.state != State::kReceiving) return;
    found->second.state = State::kWaiting;
    found->second.ticket = ++tickets_;
  }
  GiveTurns();
  StopWaitingIfClosed();
}

// The call whose turn it is, now at work, or null.
std::shared_ptr<LiveCall> CallRegistry::NextTurnLocked() {
  if (working_ >= limits_.max_jobs) return nullptr;
  Entry* next = nullptr;
  const auto rank = [this](const Entry& entry) { return std::pair(clients_.at(entry.client).working, entry.ticket); };
  for (auto& [key, entry] : calls_) {
    if (entry.state == State::kWaiting && (next == nullptr || rank(entry) < rank(*next))) next = &entry;
  }
  if (next == nullptr) return nullptr;
  next->state = State::kWorking;
  ++clients_.at(next->client).working;
  ++working_;
  --queued_;
  return next->call;
}

void CallRegistry::GiveTurns() {
  for (;;) {
    std::shared_ptr<LiveCall> call;
    {
      const std::lock_guard lock(mu_);
      call = NextTurnLocked();
    }
    if (!call) return;
    call->Work();
  }
}

void CallRegistry::VacateLocked(Entry& entry) {
  const State state = std::exchange(entry.state, State::kVacated);
  if (state == State::kVacated) return;
  const auto client = clients_.find(entry.client);
  if (state == State::kWorking) {
    --working_;
    --client->second.working;
  } else {
    --queued_;
  }
  if (--client->second.jobs == 0) clients_.erase(client);
}

void CallRegistry::Vacate(const LiveCall* call) {
  {
    const std::lock_guard lock(mu_);
    if (const auto found = calls_.find(call); found != calls_.end()) VacateLocked(found->second);
  }
  GiveTurns();
}

void CallRegistry::Remove(const LiveCall* call) {
  std::shared_ptr<LiveCall> removed;  // dies after the lock is released
  {
    const std::lock_guard lock(mu_);
    const auto found = calls_.find(call);
    if (found == calls_.end()) return;
    VacateLocked(found->second);
    removed = std::move(found->second.call);
    calls_.erase(found);
    if (calls_.empty()) empty_.notify_all();
  }
  GiveTurns();
}

template <class F>
CallRegistry::Calls CallRegistry::Select(const F& wanted) const {
  const std::lock_guard lock(mu_);
  Calls calls;
  for (const auto& [key, entry] : calls_) {
    if (wanted(entry)) calls.push_back(entry.call);
  }
  return calls;
}

void CallRegistry::Close() {
  {
    const std::lock_guard lock(mu_);
    closed_ = true;
  }
  StopWaitingIfClosed();
}

// They would do better elsewhere.
void CallRegistry::StopWaitingIfClosed() {
  const auto in_vain = [this](const Entry& entry) { return closed_ && entry.state == State::kWaiting; };
  for (const auto& call : Select(in_vain)) call->Stop(Stopping());
}

void CallRegistry::StopAll() {
  for (const auto& call : Select([](const Entry&) { return true; })) call->Stop(Stopping());
}

void CallRegistry::EndStalled(absl::Duration patience) {
  for (const auto& call : Select([](const Entry&) { return true; })) call->EndIfStalled(patience);
}

bool CallRegistry::WaitUntilEmpty(absl::Duration timeout) {
  std::unique_lock lock(mu_);
  return empty_.wait_for(lock, absl::ToChronoNanoseconds(timeout), [this] { return calls_.empty(); });
}

size_t CallRegistry::size() const {
  const std::lock_guard lock(mu_);
  return calls_.size();
}

size_t CallRegistry::working() const {
  const std::lock_guard lock(mu_);
  return working_;
}

size_t CallRegistry::queued() const {
  const std::lock_guard lock(mu_);
  return queued_;
}

}  // namespace latvox
