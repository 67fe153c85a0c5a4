// The calls Voxelize and VoxelizeStored, whose answers are streams.
#ifndef LATVOX_SERVER_CALLS_VOXELIZE_REACTOR_H_
#define LATVOX_SERVER_CALLS_VOXELIZE_REACTOR_H_

#include <grpcpp/support/server_callback.h>

#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "latvox/v1/voxelizer.pb.h"
#include "server/calls/upload_call.h"
#include "server/calls/voxel_call.h"

namespace latvox {

// Receives specification and mesh as a stream.
class VoxelizeReactor final
    : public StreamedAnswer<UploadCall<grpc::ServerBidiReactor<v1::VoxelizeRequest, v1::VoxelizeResponse>,
                                       v1::VoxelizeRequest, VoxelCall>> {
 public:
  VoxelizeReactor(grpc::CallbackServerContext& context, CallOrigin origin, const CallEnvironment& environment)
      : StreamedAnswer(context, std::move(origin), environment) {}

 private:
  absl::StatusOr<bool> ReceiveSpec(const v1::VoxelizeSpec& spec) override {
    const absl::Status status = TakeSpec(spec);
    return status.ok() ? absl::StatusOr<bool>(true) : status;
  }
  absl::Status ReceivePiece(std::string&& piece) override { return TakePiece(std::move(piece)); }
  bool HasEnded() const override { return has_ended(); }
};

// Finds the mesh in the store.
class VoxelizeStoredReactor final
    : public StreamedAnswer<CallReactor<grpc::ServerWriteReactor<v1::VoxelizeResponse>, VoxelCall>> {
 public:
  // `request` lives until OnDone.
  VoxelizeStoredReactor(grpc::CallbackServerContext& context, const v1::VoxelizeStoredRequest& request,
                        CallOrigin origin, const CallEnvironment& environment)
      : StreamedAnswer(context, std::move(origin), environment), request_(request) {}

 private:
  absl::Status Check() const override { return CheckSize(request_, environment_.limits); }
  void Start() override;

  const v1::VoxelizeStoredRequest& request_;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_CALLS_VOXELIZE_REACTOR_H_
