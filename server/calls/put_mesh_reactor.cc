#include "server/calls/put_mesh_reactor.h"

#include <optional>
#include <utility>

#include "server/base/exceptions.h"
#include "server/wire/convert.h"

namespace latvox {

PutMeshReactor::PutMeshReactor(grpc::CallbackServerContext& context, v1::PutMeshResponse& response, CallOrigin origin,
                               const CallEnvironment& environment)
    : UploadCall(context, std::move(origin), environment),
      response_(response),
      memory_(environment.memory, environment.client) {
  response_.set_request_id(origin_.request_id);
}

absl::StatusOr<bool> PutMeshReactor::ReceiveSpec(const v1::PutMeshSpec& spec) {
  const absl::StatusOr<MeshSpec> mesh = MeshSpecFromProto(spec, environment_.limits, environment_.meshes.capacity());
  if (!mesh.ok()) return mesh.status();
  digest_ = mesh->digest;
  if (mesh->raw) raw_mesh_.emplace(*mesh->raw);
  if (environment_.meshes.Find(digest_)) {
    response_.set_already_stored(true);
    return false;
  }
  upload_.emplace(mesh->bytes, environment_.limits.max_mesh_bytes);
  return true;
}

// A piece that is refused is not counted.
absl::Status PutMeshReactor::ReceivePiece(std::string&& piece) {
  absl::Status status = raw_mesh_ ? raw_mesh_->Add(piece) : absl::OkStatus();
  status.Update(upload_->Append(std::move(piece)));
  if (!status.ok()) return status;
  bytes_in_ = upload_->size();
  return memory_.Grow(bytes_in_);
}

void PutMeshReactor::Work() {
  if (!BeginTask(ready())) return;
  WorkQueue& queue = upload_->size() > kLargeMeshBytes ? *Bulk() : environment_.quick;
  queue.Enqueue([self = ShareOf(*this), &queue] {
    self->EndTask(WithoutExceptions([&self] { return self->Store(); }));
    DoOrdinarily(queue, self->environment_.quick, [self] { self->SendStatus(); });
  });
}

absl::Status PutMeshReactor::Store() {
  const absl::Cord mesh = (*std::exchange(upload_, std::nullopt)).Release();
  return environment_.meshes.PutIfItHas(digest_, mesh, stop_.Signal()).status();
}

void PutMeshReactor::Describe(RequestRecord& record) const {
  UploadCall::Describe(record);
  record.bytes_out = record.status.ok() ? response_.ByteSizeLong() : 0;
}

}  // namespace latvox
