// The call PutMesh: gRPC's callbacks on one side, a task of the compute arena on the other.
#ifndef LATVOX_SERVER_CALLS_PUT_MESH_REACTOR_H_
#define LATVOX_SERVER_CALLS_PUT_MESH_REACTOR_H_

#include <grpcpp/support/server_callback.h>

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "latvox/v1/voxelizer.pb.h"
#include "server/calls/upload_call.h"
#include "server/decode/mesh_store.h"
#include "server/work/memory_budget.h"

namespace latvox {

// Receives a mesh; then a task checks the digest and stores the mesh.
class PutMeshReactor final : public UploadCall<grpc::ServerReadReactor<v1::PutMeshRequest>, v1::PutMeshRequest> {
 public:
  // `response` lives until OnDone.
  PutMeshReactor(grpc::CallbackServerContext& context, v1::PutMeshResponse& response, CallOrigin origin,
                 const CallEnvironment& environment);

  void Work() override;

 private:
  absl::StatusOr<bool> ReceiveSpec(const v1::PutMeshSpec& spec) override;
  absl::Status ReceivePiece(std::string&& piece) override;
  bool HasEnded() const override { return finishing_; }
  void Describe(RequestRecord& record) const override;
  void Free() override { memory_.Shrink(0); }
  absl::Status Store();

  v1::PutMeshResponse& response_;
  MeshDigest digest_{};
  MemoryReservation memory_;
  std::optional<RawMeshCheck> raw_mesh_;  // of the pieces, if they are plain arrays
};

}  // namespace latvox

#endif  // LATVOX_SERVER_CALLS_PUT_MESH_REACTOR_H_
