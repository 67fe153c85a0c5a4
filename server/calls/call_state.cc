#include "server/calls/call_state.h"

#include "server/base/milliseconds.h"
#include "server/calls/metrics.h"

namespace latvox {

void CallState::Begin() {
  self_ = shared_from_this();
  absl::Status status = Check();
  if (status.ok()) {
    status = environment_.registry.Admit(self_, origin_.caller.client, origin_.caller.limits.max_jobs);
  }
  status.ok() ? Start() : End(status);
}

void CallState::End(const absl::Status& status) {
  {
    const std::lock_guard lock(mu_);
    if (finishing_ || !status_.ok()) return;
    status_ = status;
    stop_.Stop();
    if (working_) return;  // EndTask follows
    SetFinishing();
  }
  SendStatus();
}

bool CallState::BeginTask(Clock::time_point ready) {
  const std::lock_guard lock(mu_);
  if (finishing_) return false;
  queue_ms_ = MillisecondsSince(ready);
  working_ = true;
  return true;
}

void CallState::EndTask(const absl::Status& status) {
  const std::lock_guard lock(mu_);
  working_ = false;
  SetFinishing();
  if (status_.ok()) status_ = status;
}

const std::shared_ptr<WorkQueue>& CallState::Bulk() {
  if (!lane_) lane_ = environment_.bulk.LaneOf(environment_.client);
  return lane_;
}

void CallState::SetFinishing() {
  finishing_ = true;
  finished_ = Clock::now();
}

void CallState::EndIfStalled(absl::Duration patience) {
  bool stuck = false;
  {
    const std::lock_guard lock(mu_);
    stuck = finishing_;
    const auto since = stuck ? finished_ : heard_of_client_;
    if (!(stuck || IsReading()) || absl::FromChrono(Clock::now() - since) < patience) return;
  }
  const absl::Status status = StalledClient(patience);
  End(status);
  // An answer that the client does not take ends in no other way.
  if (stuck) canceller_.Cancel(status);
}

void CallState::SendStatus() {
  environment_.registry.Vacate(this);
  FinishWith(StatusForClient(status_, context_));
}

void CallState::Done() {
  canceller_.Over();
  RequestRecord record;
  record.origin = origin_;
  {
    const std::lock_guard lock(mu_);
    record.status = status_;
    record.queue_ms = queue_ms_;
    Describe(record);
  }
  record.total_ms = MillisecondsSince(began_);
  LogRequest(record);
  environment_.metrics.Record(record);
  Free();
  environment_.registry.Remove(this);
  self_.reset();  // this may be gone
}

}  // namespace latvox
