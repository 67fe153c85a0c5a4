#include "server/calls/pixelize_reactor.h"

#include <utility>

namespace latvox {

PixelizeReactor::PixelizeReactor(grpc::CallbackServerContext& context, const v1::PixelizeRequest& request,
                                 v1::PixelizeResponse& response, CallOrigin origin, const CallEnvironment& environment)
    : CallReactor(context, std::move(origin), environment),
      request_(request),
      response_(response),
      bytes_in_(request.ByteSizeLong()),
      memory_(environment.memory, environment.client) {}

void PixelizeReactor::Work() {
  if (!BeginTask(began_)) return;
  WorkQueue& queue = LastsLong(request_) ? *Bulk() : environment_.quick;
  queue.Enqueue([self = ShareOf(*this)] { self->Compute(); });
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
  memory_.Shrink(bytes_in_ + bytes_out_);  // the messages, until the client has taken the answer
  EndTask(computed);
  SendStatus();
}

void PixelizeReactor::Describe(RequestRecord& record) const {
  record.lattice = facts_.lattice;
  record.separability = facts_.separability;
  if (record.queue_ms) record.work = facts_;
  record.bytes_in = bytes_in_;
  record.bytes_out = record.status.ok() ? bytes_out_ : 0;
}

}  // namespace latvox
