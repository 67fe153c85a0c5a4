// The call Pixelize: gRPC's callbacks on one side, a task of the compute arena on the other.
#ifndef LATVOX_SERVER_CALLS_PIXELIZE_REACTOR_H_
#define LATVOX_SERVER_CALLS_PIXELIZE_REACTOR_H_

#include <grpcpp/support/server_callback.h>

#include <cstdint>

#include "absl/status/status.h"
#include "latvox/v1/voxelizer.pb.h"
#include "server/calls/call_state.h"
#include "server/work/memory_budget.h"
#include "server/work/pixelization.h"

namespace latvox {

// Finish follows once the task is over, because until then the task reads the request and writes the response, which
// are gRPC's. The request comes as a whole; a client can only fail to take the answer.
class PixelizeReactor final : public CallReactor<grpc::ServerUnaryReactor> {
 public:
  // `request` and `response` live until OnDone.
  PixelizeReactor(grpc::CallbackServerContext& context, const v1::PixelizeRequest& request,
                  v1::PixelizeResponse& response, CallOrigin origin, const CallEnvironment& environment);

  void Work() override;

 private:
  absl::Status Check() const override { return CheckSize(request_, environment_.limits); }
  void Start() override { environment_.registry.AwaitTurn(this); }
  void Describe(RequestRecord& record) const override;
  void Free() override { memory_.Shrink(0); }
  void Compute();

  const v1::PixelizeRequest& request_;
  v1::PixelizeResponse& response_;
  const uint64_t bytes_in_;

  // The task's, until it is over.
  PixelizationFacts facts_;
  MemoryReservation memory_;
  uint64_t bytes_out_ = 0;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_CALLS_PIXELIZE_REACTOR_H_
