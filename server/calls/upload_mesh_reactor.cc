#include "server/calls/upload_mesh_reactor.h"

#include <utility>

#include "server/base/exceptions.h"
#include "server/wire/convert.h"

namespace latvox {

UploadMeshReactor::UploadMeshReactor(grpc::CallbackServerContext& context, v1::UploadMeshRequest& request,
                                     v1::UploadMeshResponse& response, CallOrigin origin,
                                     const CallEnvironment& environment)
    : CallReactor(context, std::move(origin), environment),
      request_(request),
      response_(response),
      bytes_in_(request.mesh_piece().size()) {
  response_.set_request_id(origin_.request_id);
}

void UploadMeshReactor::Start() {
  const absl::Status status = Receive();
  status.ok() && complete_ ? environment_.registry.AwaitTurn(this) : End(status);
}

absl::Status UploadMeshReactor::Receive() {
  const auto mesh = MeshSpecFromProto(request_.spec(), environment_.limits, environment_.meshes.capacity());
  if (!mesh.ok()) return mesh.status();
  if (IsStored(*mesh)) return absl::OkStatus();
  auto progress = environment_.uploads.Add(environment_.client, *mesh, request_.offset(),
                                           std::move(*request_.mutable_mesh_piece()));
  if (!progress.ok()) return progress.status();
  if (IsStored(*mesh)) {
    // By another call, meanwhile. Nobody would go on with this upload.
    environment_.uploads.Drop(environment_.client, *mesh);
    return absl::OkStatus();
  }
  response_.set_next_offset(progress->next_offset);
  complete_ = std::move(progress->complete);
  return absl::OkStatus();
}

bool UploadMeshReactor::IsStored(const MeshSpec& mesh) {
  const auto stored = environment_.meshes.Find(mesh.digest);
  if (!stored) return false;
  response_.set_next_offset(stored->size());
  response_.set_stored(true);
  return true;
}

void UploadMeshReactor::Work() {
  if (!BeginTask(began_)) return;
  WorkQueue& queue = complete_->mesh.bytes > kLargeMeshBytes ? *Bulk() : environment_.quick;
  queue.Enqueue([self = ShareOf(*this), &queue] {
    self->EndTask(WithoutExceptions([&self] { return self->Store(); }));
    DoOrdinarily(queue, self->environment_.quick, [self] { self->SendStatus(); });
  });
}

// A mesh of another digest than it should have is of no use, so the upload begins again.
absl::Status UploadMeshReactor::Store() {
  const absl::Status status =
      environment_.meshes.PutIfItHas(complete_->mesh.digest, complete_->bytes, stop_.Signal()).status();
  if (!absl::IsCancelled(status)) environment_.uploads.Drop(complete_);
  response_.set_stored(status.ok());
  return status;
}

void UploadMeshReactor::Describe(RequestRecord& record) const {
  record.bytes_in = bytes_in_;
  record.bytes_out = record.status.ok() ? response_.ByteSizeLong() : 0;
}

}  // namespace latvox
