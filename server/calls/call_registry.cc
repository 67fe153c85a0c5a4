#include "server/calls/call_registry.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/base/errors.h"

namespace latvox {
namespace {

// Long enough for many jobs to end, short enough not to leave a free place unused.
constexpr absl::Duration kRetryDelay = absl::Seconds(1);

absl::Status TooMany(absl::string_view what, const char* reason, uint64_t limit, const char* limit_name) {
  return WithRetry(MakeError(absl::StatusCode::kResourceExhausted,
                             absl::StrCat(what, ": ", limit, " of ", limit, " are in progress; try again"),
                             {reason, std::string{what}, absl::StrCat(limit), absl::StrCat(limit), limit_name}),
                   kRetryDelay);
}

absl::Status Stopping() {
  return WithRetry(MakeError(absl::StatusCode::kUnavailable, "the server is stopping", {"SERVER_STOPPING", "", "", ""}),
                   kRetryDelay);
}

}  // namespace

size_t CallRegistry::Count(std::initializer_list<State> states) const {
  const std::lock_guard lock(mu_);
  size_t count = 0;
  for (const State state : states) count += counts_[state];
  return count;
}

void CallRegistry::Move(Entry& entry, State state) {
  --counts_[entry.state];
  ++counts_[state];
  if (entry.state == kWorking) --clients_.at(entry.client).working;
  if (state == kWorking) {
    ++clients_.at(entry.client).working;
    works_.notify_all();
  }
  entry.state = state;
}

// A paused call counts as before, because it comes back without another admission.
absl::Status CallRegistry::CheckRoom(const std::string& client, uint32_t max_jobs_of_client) const {
  if (closed_) return Stopping();
  const uint64_t limit = uint64_t{limits_.max_jobs} + limits_.max_queued_jobs;
  if (calls_.size() - counts_[kVacated] >= limit) return TooMany("jobs", "TOO_MANY_JOBS", limit, "");  // two limits
  const uint32_t share =
      max_jobs_of_client == 0 ? limits_.max_jobs_per_client : std::min(max_jobs_of_client, limits_.max_jobs_per_client);
  const auto found = clients_.find(client);
  if (found != clients_.end() && found->second.jobs >= share) {
    return TooMany("jobs_of_client", "TOO_MANY_JOBS_OF_CLIENT", share, "max_jobs_per_client");
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
  ++counts_[kReceiving];
  return absl::OkStatus();
}

void CallRegistry::AwaitTurn(const LiveCall* call) {
  {
    const std::lock_guard lock(mu_);
    const auto found = calls_.find(call);
    if (found == calls_.end()) return;
    Entry& entry = found->second;
    if (entry.state != kReceiving && entry.state != kPaused) return;
    Move(entry, entry.state == kReceiving ? kWaiting : kReturning);
    entry.ticket = ++tickets_;
  }
  GiveTurns(call);
  StopWaitingIfClosed();
}

void CallRegistry::Pause(const LiveCall* call) {
  {
    const std::lock_guard lock(mu_);
    const auto found = calls_.find(call);
    if (found == calls_.end() || found->second.state == kVacated) return;
    Move(found->second, kPaused);
  }
  GiveTurns();
}

// Returns the call that has the next turn, and counts it as working; or null.
std::shared_ptr<LiveCall> CallRegistry::NextTurnLocked() {
  if (counts_[kWorking] >= limits_.max_jobs) return nullptr;
  const auto rank = [&](const Entry& entry) {
    return std::tuple(clients_.at(entry.client).working, (entry.state == kWaiting) != new_is_next_, entry.ticket);
  };
  Entry* next = nullptr;
  for (auto& [key, entry] : calls_) {
    const bool waits = entry.state == kWaiting || entry.state == kReturning;
    if (waits && (next == nullptr || rank(entry) < rank(*next))) next = &entry;
  }
  if (next == nullptr) return nullptr;
  new_is_next_ = next->state == kReturning;
  Move(*next, kWorking);
  return next->call;
}

void CallRegistry::GiveTurns(const LiveCall* asking) {
  for (;;) {
    std::shared_ptr<LiveCall> call;
    {
      const std::lock_guard lock(mu_);
      call = NextTurnLocked();
    }
    if (!call) return;
    call.get() == asking ? call->WorkHere() : call->Work();
  }
}

void CallRegistry::VacateLocked(Entry& entry) {
  if (entry.state == kVacated) return;
  Move(entry, kVacated);
  const auto client = clients_.find(entry.client);
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
  std::shared_ptr<LiveCall> removed;  // destroyed after the lock is released
  {
    const std::lock_guard lock(mu_);
    const auto found = calls_.find(call);
    if (found == calls_.end()) return;
    VacateLocked(found->second);
    --counts_[kVacated];
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
    works_.notify_all();
  }
  StopWaitingIfClosed();
}

// Stops waiting calls: another server can take them sooner.
void CallRegistry::StopWaitingIfClosed() {
  const auto in_vain = [this](const Entry& entry) { return closed_ && entry.state == kWaiting; };
  for (const auto& call : Select(in_vain)) call->Stop(Stopping());
}

void CallRegistry::StopAll() {
  for (const auto& call : Select([](const Entry&) { return true; })) call->Stop(Stopping());
}

void CallRegistry::EndStalled(absl::Duration patience) {
  for (const auto& call : Select([](const Entry&) { return true; })) call->EndIfStalled(patience);
}

void CallRegistry::Oversee() {
  for (const auto& call : Select([](const Entry& entry) { return entry.state == kWorking; })) call->Oversee();
}

void CallRegistry::WaitForWork(absl::Duration timeout) {
  std::unique_lock lock(mu_);
  works_.wait_for(lock, absl::ToChronoNanoseconds(timeout), [this] { return closed_ || counts_[kWorking] > 0; });
}

bool CallRegistry::WaitUntilEmpty(absl::Duration timeout) {
  std::unique_lock lock(mu_);
  return empty_.wait_for(lock, absl::ToChronoNanoseconds(timeout), [this] { return calls_.empty(); });
}

size_t CallRegistry::size() const {
  const std::lock_guard lock(mu_);
  return calls_.size();
}

size_t CallRegistry::working() const { return Count({kWorking}); }

size_t CallRegistry::queued() const { return Count({kReceiving, kWaiting, kReturning}); }

size_t CallRegistry::paused() const { return Count({kPaused}); }

}  // namespace latvox
