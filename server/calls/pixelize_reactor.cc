#include "server/calls/pixelize_reactor.h"

#include <utility>

#include "server/base/milliseconds.h"
#include "server/calls/metrics.h"
#include "server/calls/request_log.h"

namespace latvox {

PixelizeReactor::PixelizeReactor(grpc::CallbackServerContext& context, const v1::PixelizeRequest& request,
                                 v1::PixelizeResponse& response, CallOrigin origin, const CallEnvironment& environment)
    : context_(context),
      canceller_(context),
      request_(request),
      response_(response),
      environment_(environment),
      origin_(std::move(origin)),
      bytes_in_(request.ByteSizeLong()),
      memory_(environment.memory) {}

void PixelizeReactor::Begin() {
  self_ = shared_from_this();
  if (absl::Status status = CheckSize(request_, environment_.limits); !status.ok()) return End(status);
  if (absl::Status status = environment_.registry.Admit(self_, origin_.caller.client, origin_.caller.limits.max_jobs);
      !status.ok()) {
    return End(status);
  }
  environment_.registry.AwaitTurn(this);
}

void PixelizeReactor::Work() {
  {
    const std::lock_guard lock(mu_);
    if (finishing_) return;
    queue_ms_ = MillisecondsSince(began_);
    computing_ = true;
  }
  WorkQueue& queue = LastsLong(request_) ? environment_.bulk : environment_.quick;
  queue.Enqueue([self = shared_from_this()] { self->Compute(); });
}

void PixelizeReactor::Compute() {
  absl::StatusOr<v1::PixelizeResponse> response =
      PixelizePolylines(request_, environment_.limits, memory_, stop_.Signal(), facts_);
  const absl::Status computed = response.status();
  if (response.ok()) {
    response_ = *std::move(response);
    response_.set_request_id(origin_.request_id);
    bytes_out_ = response_.ByteSizeLong();
  }
  memory_.Shrink(bytes_in_ + bytes_out_);  // messages, until the client has taken the answer
  {
    const std::lock_guard lock(mu_);
    computing_ = false;
    finishing_ = true;
    finished_ = Clock::now();
    if (status_.ok()) status_ = computed;
  }
  SendStatus();
}

// The first error stands.
void PixelizeReactor::End(const absl::Status& status) {
  {
    const std::lock_guard lock(mu_);
    if (finishing_ || !status_.ok()) return;
    status_ = status;
    stop_.Stop();
    if (computing_) return;
    finishing_ = true;
    finished_ = Clock::now();
  }
  SendStatus();
}

// The request came as a whole; what a client may leave is the answer.
void PixelizeReactor::EndIfStalled(absl::Duration patience) {
  {
    const std::lock_guard lock(mu_);
    if (!finishing_ || absl::FromChrono(Clock::now() - finished_) < patience) return;
  }
  canceller_.Cancel(StalledClient(patience));
}

void PixelizeReactor::SendStatus() {
  environment_.registry.Vacate(this);
  Finish(StatusForClient(status_, context_));
}

void PixelizeReactor::OnDone() {
  canceller_.Over();
  RequestRecord record;
  record.origin = origin_;
  record.status = status_;
  record.lattice = facts_.lattice;
  record.separability = facts_.separability;
  if (queue_ms_) record.work = facts_;
  record.bytes_in = bytes_in_;
  record.bytes_out = status_.ok() ? bytes_out_ : 0;
  record.queue_ms = queue_ms_;
  record.total_ms = MillisecondsSince(began_);
  LogRequest(record);
  environment_.metrics.Record(record);
  memory_.Shrink(0);  // the server may be gone before this object is
  environment_.registry.Remove(this);
  self_.reset();
}

}  // namespace latvox
