// The call UploadMesh: one piece of a mesh. A task works only for the last one.
#ifndef LATVOX_SERVER_CALLS_UPLOAD_MESH_REACTOR_H_
#define LATVOX_SERVER_CALLS_UPLOAD_MESH_REACTOR_H_

#include <grpcpp/support/server_callback.h>

#include <cstdint>
#include <memory>

#include "absl/status/status.h"
#include "latvox/v1/voxelizer.pb.h"
#include "server/calls/call_state.h"
#include "server/work/unfinished_uploads.h"

namespace latvox {

// Adds the piece to its upload. Once the mesh is complete, a task checks the digest and stores it. If the call ends
// before that, the next call for the mesh does it.
class UploadMeshReactor final : public CallReactor<grpc::ServerUnaryReactor> {
 public:
  // `request`, whose piece is moved away, and `response` live until OnDone.
  UploadMeshReactor(grpc::CallbackServerContext& context, v1::UploadMeshRequest& request,
                    v1::UploadMeshResponse& response, CallOrigin origin, const CallEnvironment& environment);

  void Work() override;

 private:
  absl::Status Check() const override { return CheckSize(request_, environment_.limits); }
  void Start() override;
  void Describe(RequestRecord& record) const override;
  void Free() override { complete_.reset(); }
  absl::Status Receive();
  // Then sets the response.
  bool IsStored(const MeshSpec& mesh);
  absl::Status Store();

  v1::UploadMeshRequest& request_;
  v1::UploadMeshResponse& response_;
  const uint64_t bytes_in_;
  std::shared_ptr<const UnfinishedUploads::Upload> complete_;  // null: no work is left
};

}  // namespace latvox

#endif  // LATVOX_SERVER_CALLS_UPLOAD_MESH_REACTOR_H_
