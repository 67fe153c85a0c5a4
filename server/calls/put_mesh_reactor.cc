#include "server/calls/put_mesh_reactor.h"

#include <utility>

#include "server/base/errors.h"
#include "server/base/exceptions.h"
#include "server/base/milliseconds.h"
#include "server/calls/metrics.h"
#include "server/calls/request_log.h"

namespace latvox {

PutMeshReactor::PutMeshReactor(grpc::CallbackServerContext& context, v1::PutMeshResponse& response, CallOrigin origin,
                               const CallEnvironment& environment)
    : context_(context),
      canceller_(context),
      response_(response),
      environment_(environment),
      origin_(std::move(origin)),
      memory_(environment.memory) {
  response_.set_request_id(origin_.request_id);
}

void PutMeshReactor::Begin() {
  self_ = shared_from_this();
  if (absl::Status status = environment_.registry.Admit(self_, origin_.caller.client, origin_.caller.limits.max_jobs);
      !status.ok())
    return End(status);
  Read();
}

void PutMeshReactor::Read() {
  MarkUnread(request_);
  StartRead(&request_);
}

void PutMeshReactor::OnReadDone(bool ok) {
  if (!ok) return FinishReading();
  const uint64_t before = bytes_in_;
  const absl::StatusOr<bool> more = TakeRequest();
  if (!more.ok() || !*more) return End(more.status());
  const std::lock_guard lock(mu_);
  if (bytes_in_ > before || request_.has_spec()) last_read_ = Clock::now();
  if (!finishing_) Read();
}

// Whether more is to be read.
absl::StatusOr<bool> PutMeshReactor::TakeRequest() {
  if (absl::Status status = CheckSize(request_, environment_.limits); !status.ok()) return status;
  DropUnknownFields(request_);
  switch (request_.part_case()) {
    case v1::PutMeshRequest::kSpec:
      if (upload_) return BadStream("spec: a second one came; it is the first message, and exactly one");
      return TakeSpec(request_.spec());
    case v1::PutMeshRequest::kMeshPiece: {
      if (!upload_) return BadStream("mesh_piece came before spec");
      if (absl::Status status = upload_->Append(std::move(*request_.mutable_mesh_piece())); !status.ok()) return status;
      bytes_in_ = upload_->size();
      if (absl::Status status = memory_.Grow(bytes_in_); !status.ok()) return status;
      return true;
    }
    case v1::PutMeshRequest::PART_NOT_SET:
      break;
  }
  return BadStream("a message has neither spec nor mesh_piece");
}

absl::StatusOr<bool> PutMeshReactor::TakeSpec(const v1::PutMeshSpec& spec) {
  const absl::StatusOr<MeshDigest> digest = MeshDigestFrom(spec.mesh_sha256());
  if (!digest.ok()) return digest.status();
  digest_ = *digest;
  if (spec.mesh_bytes() == 0) return BadSpec("mesh_bytes 0 is below 1", "mesh_bytes", "0", "1");
  const uint64_t limit = environment_.limits.max_mesh_bytes, capacity = environment_.meshes.capacity();
  if (spec.mesh_bytes() > limit) return LimitExceeded("mesh_bytes", spec.mesh_bytes(), limit);
  if (spec.mesh_bytes() > capacity) {
    return LimitExceeded("mesh_bytes", spec.mesh_bytes(), capacity, "mesh_store_bytes");
  }
  if (environment_.meshes.Find(digest_)) {
    response_.set_already_stored(true);
    return false;
  }
  upload_.emplace(spec.mesh_bytes(), limit);
  return true;
}

// The client has half-closed, or the call is broken.
void PutMeshReactor::FinishReading() {
  if (context_.IsCancelled()) return OnCancel();
  if (!IsUnread(request_)) return End(UnreadableMessage(request_));
  if (const absl::Status status = CheckUpload(); !status.ok()) {
    sent_too_little_ = true;
    return End(status);
  }
  {
    const std::lock_guard lock(mu_);
    reading_ = false;
    upload_ms_ = upload_->milliseconds();
    waits_since_ = Clock::now();
  }
  environment_.registry.AwaitTurn(this);
}

absl::Status PutMeshReactor::CheckUpload() const {
  return upload_ ? upload_->CheckComplete() : BadStream("the stream ended before spec");
}

void PutMeshReactor::Work() {
  {
    const std::lock_guard lock(mu_);
    if (finishing_) return;
    queue_ms_ = MillisecondsSince(waits_since_);
    working_ = true;
  }
  WorkQueue& queue = upload_->size() > kLargeMeshBytes ? environment_.bulk : environment_.quick;
  queue.Enqueue([self = shared_from_this(), &queue] {
    const absl::Status stored = WithoutExceptions([&self] { return self->Store(); });
    {
      const std::lock_guard lock(self->mu_);
      self->working_ = false;
      self->finishing_ = true;
      self->finished_ = Clock::now();
      if (self->status_.ok()) self->status_ = stored;
    }
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

// The first status stands.
void PutMeshReactor::End(const absl::Status& status) {
  {
    const std::lock_guard lock(mu_);
    if (finishing_ || !status_.ok()) return;
    status_ = status;
    stop_.Stop();
    if (working_) return;
    finishing_ = true;
    finished_ = Clock::now();
  }
  SendStatus();
}

void PutMeshReactor::EndIfStalled(absl::Duration patience) {
  bool stuck = false;
  {
    const std::lock_guard lock(mu_);
    const auto since = finishing_ ? finished_ : last_read_;
    if (!(reading_ || finishing_) || absl::FromChrono(Clock::now() - since) < patience) return;
    stuck = finishing_;
  }
  const absl::Status status = StalledClient(patience);
  End(status);
  if (stuck) canceller_.Cancel(status);
}

void PutMeshReactor::SendStatus() {
  environment_.registry.Vacate(this);
  Finish(StatusForClient(status_, context_));
}

void PutMeshReactor::OnDone() {
  canceller_.Over();
  RequestRecord record;
  record.origin = origin_;
  record.status = sent_too_little_ && context_.IsCancelled() ? BrokenRead(environment_.limits) : status_;
  record.bytes_in = bytes_in_;
  record.bytes_out = record.status.ok() ? response_.ByteSizeLong() : 0;
  record.upload_ms = upload_ms_;
  record.queue_ms = queue_ms_;
  record.total_ms = MillisecondsSince(began_);
  LogRequest(record);
  environment_.metrics.Record(record);
  memory_.Shrink(0);  // the server may be gone before this object is
  environment_.registry.Remove(this);
  self_.reset();
}

}  // namespace latvox
