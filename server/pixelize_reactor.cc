#include "server/pixelize_reactor.h"

#include <utility>

#include "server/request_log.h"

namespace latvox {

PixelizeReactor::PixelizeReactor(grpc::CallbackServerContext& context, const v1::PixelizeRequest& request,
                                 v1::PixelizeResponse& response, CallOrigin origin, const CallEnvironment& environment)
    : context_(context),
      request_(request),
      response_(response),
      environment_(environment),
      origin_(std::move(origin)),
      bytes_in_(request.ByteSizeLong()) {}

void PixelizeReactor::Begin() {
  self_ = shared_from_this();
  if (absl::Status status = environment_.registry.Admit(self_); !status.ok()) return End(status);
  {
    const std::lock_guard lock(mu_);
    if (finishing_) return;
    computing_ = true;
  }
  environment_.arena.enqueue([self = shared_from_this()] { self->Compute(); });
}

void PixelizeReactor::Compute() {
  absl::StatusOr<v1::PixelizeResponse> response = PixelizePolylines(request_, environment_.limits, cancelled_, facts_);
  const absl::Status computed = response.status();
  if (response.ok()) {
    response_ = *std::move(response);
    response_.set_request_id(origin_.request_id);
    bytes_out_ = response_.ByteSizeLong();
  }
  {
    const std::lock_guard lock(mu_);
    computing_ = false;
    finishing_ = true;
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
    cancelled_ = true;
    if (computing_) return;
    finishing_ = true;
  }
  SendStatus();
}

void PixelizeReactor::SendStatus() {
  environment_.registry.Vacate(this);
  Finish(StatusForClient(status_, context_));
}

void PixelizeReactor::OnDone() {
  RequestRecord record;
  record.origin = origin_;
  record.status = status_;
  record.lattice = facts_.lattice;
  record.separability = facts_.separability;
  record.work = facts_;
  record.bytes_in = bytes_in_;
  record.bytes_out = status_.ok() ? bytes_out_ : 0;
  record.total_ms = std::chrono::duration<double, std::milli>(Clock::now() - began_).count();
  LogRequest(record);
  environment_.metrics.Record(record);
  environment_.registry.Remove(this);
  self_.reset();
}

}  // namespace latvox
