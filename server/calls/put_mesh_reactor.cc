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
  const absl::StatusOr<MeshDigest> digest = MeshDigestFrom(spec.mesh_sha256());
  if (!digest.ok()) return digest.status();
  digest_ = *digest;
  if (spec.mesh_bytes() == 0) return BadSpec("mesh_bytes 0 is below 1", "mesh_bytes", "0", "1");
  const uint64_t limit = environment_.limits.max_mesh_bytes, capacity = environment_.meshes.capacity();
  if (spec.mesh_bytes() > limit) return LimitExceeded("mesh_bytes", spec.mesh_bytes(), limit);
  if (spec.mesh_bytes() > capacity) {
    return LimitExceeded("mesh_bytes", spec.mesh_bytes(), capacity, "mesh_store_bytes");
  }
  if (spec.has_raw_mesh()) {
    const absl::StatusOr<RawMeshLayout> layout = RawMeshFromProto(spec.raw_mesh(), environment_.limits);
    if (!layout.ok()) return layout.status();
    raw_mesh_.emplace(*layout);
  }
  if (environment_.meshes.Find(digest_)) {
    response_.set_already_stored(true);
    return false;
  }
  upload_.emplace(spec.mesh_bytes(), limit);
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
  const std::optional<MeshDigest> digest = DigestOf(mesh, stop_.Signal());
  if (!digest) return absl::CancelledError("the request was cancelled");
  if (*digest != digest_) return WrongMeshDigest();
  environment_.meshes.Put(digest_, mesh);
  return absl::OkStatus();
}

void PutMeshReactor::Describe(RequestRecord& record) const {
  UploadCall::Describe(record);
  record.bytes_out = record.status.ok() ? response_.ByteSizeLong() : 0;
}

}  // namespace latvox
