// The call VoxelizeSmall: one message each way.
#ifndef LATVOX_SERVER_CALLS_VOXELIZE_SMALL_REACTOR_H_
#define LATVOX_SERVER_CALLS_VOXELIZE_SMALL_REACTOR_H_

#include <grpcpp/support/server_callback.h>

#include <cstdint>

#include "absl/status/status.h"
#include "latvox/v1/voxelizer.pb.h"
#include "server/calls/voxel_call.h"
#include "server/work/memory_budget.h"

namespace latvox {

// Collects the messages of the answer. They leave together with the status.
class VoxelizeSmallReactor final : public CallReactor<grpc::ServerUnaryReactor, VoxelCall> {
 public:
  // `request`, whose mesh is moved away, and `response` live until OnDone.
  VoxelizeSmallReactor(grpc::CallbackServerContext& context, v1::VoxelizeSmallRequest& request,
                       v1::VoxelizeSmallResponse& response, CallOrigin origin, const CallEnvironment& environment);

 private:
  absl::Status Check() const override;
  void Start() override;
  void Write(v1::VoxelizeResponse& message, bool more) override;
  void WriteLast(v1::VoxelizeResponse& message) override;
  absl::Status AdmitAnswer(uint64_t bytes) override;
  void Describe(RequestRecord& record) const override;
  void Free() override { memory_.Shrink(0); }

  v1::VoxelizeSmallRequest& request_;
  v1::VoxelizeSmallResponse& response_;
  MemoryReservation memory_;  // of the answer; guarded by mu_ until the call is over
};

}  // namespace latvox

#endif  // LATVOX_SERVER_CALLS_VOXELIZE_SMALL_REACTOR_H_
