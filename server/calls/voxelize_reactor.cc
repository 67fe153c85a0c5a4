#include "server/calls/voxelize_reactor.h"

#include <utility>

#include "server/base/errors.h"
#include "server/base/milliseconds.h"
#include "server/calls/metrics.h"
#include "server/calls/request_log.h"

namespace latvox {

VoxelizeReactor::VoxelizeReactor(grpc::CallbackServerContext& context, CallOrigin origin,
                                 const CallEnvironment& environment)
    : context_(context), canceller_(context), environment_(environment), origin_(std::move(origin)) {}

void VoxelizeReactor::Begin() {
  self_ = shared_from_this();
  if (absl::Status status = environment_.registry.Admit(self_, origin_.caller.client, origin_.caller.limits.max_jobs);
      !status.ok())
    return End(status);
  Read();
}

void VoxelizeReactor::Read() {
  MarkUnread(request_);
  StartRead(&request_);
}

void VoxelizeReactor::OnReadDone(bool ok) {
  if (!ok) return FinishReading();
  const uint64_t before = bytes_in_;
  if (absl::Status status = TakeRequest(); !status.ok()) return End(status);
  const std::lock_guard lock(mu_);
  if (bytes_in_ > before || request_.has_spec()) heard_of_client_ = Clock::now();
  if (!ended_) Read();
}

absl::Status VoxelizeReactor::TakeRequest() {
  if (absl::Status status = CheckSize(request_, environment_.limits); !status.ok()) return status;
  DropUnknownFields(request_);
  switch (request_.part_case()) {
    case v1::VoxelizeRequest::kSpec:
      if (upload_) return BadStream("spec: a second one came; it is the first message, and exactly one");
      return TakeSpec(request_.spec());
    case v1::VoxelizeRequest::kMeshPiece: {
      if (!upload_) return BadStream("mesh_piece came before spec");
      absl::Status status = upload_->Append(std::move(*request_.mutable_mesh_piece()));
      bytes_in_ = upload_->size();
      return status.ok() ? computation_->Receive(bytes_in_) : status;
    }
    case v1::VoxelizeRequest::PART_NOT_SET:
      break;
  }
  return BadStream("a message has neither spec nor mesh_piece");
}

absl::Status VoxelizeReactor::TakeSpec(const v1::VoxelizeSpec& proto) {
  absl::StatusOr<JobSpec> spec = JobSpecFromProto(proto, environment_.limits);
  if (!spec.ok()) return spec.status();
  upload_.emplace(spec->mesh_bytes, environment_.limits.max_mesh_bytes);
  may_be_kept_ = spec->mesh_digest.has_value();
  // What will come must fit, but counts only as it comes: nobody takes memory by words.
  if (spec->mesh_bytes > environment_.memory.total()) {
    return LimitExceeded("memory", spec->mesh_bytes, environment_.memory.total());
  }
  auto computation = std::make_unique<Computation>(*std::move(spec), origin_.request_id, environment_);
  const std::lock_guard lock(mu_);
  computation_ = std::move(computation);
  return absl::OkStatus();
}

// The client has half-closed, or the call is broken.
void VoxelizeReactor::FinishReading() {
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

absl::Status VoxelizeReactor::CheckUpload() const {
  if (!upload_) return BadStream("the stream ended before spec");
  return may_be_kept_ && upload_->size() == 0 ? absl::OkStatus() : upload_->CheckComplete();
}

void VoxelizeReactor::Work() {
  {
    const std::lock_guard lock(mu_);
    if (ended_) return;
    if (!queue_ms_) queue_ms_ = MillisecondsSince(waits_since_);
    computing_ = true;
  }
  if (!upload_) return Enqueue();
  WorkQueue& digesting = upload_->size() > kLargeMeshBytes ? environment_.bulk : environment_.quick;
  digesting.Enqueue([self = shared_from_this(), &digesting] { self->TakeMesh(digesting); });
}

void VoxelizeReactor::TakeMesh(const WorkQueue& digesting) {
  const absl::Status status = computation_->ReceiveMesh(*std::exchange(upload_, std::nullopt));
  bool decode = false;
  {
    const std::lock_guard lock(mu_);
    computing_ = false;
    if (!status.ok()) EndLocked(status);
    decoding_ = decode = !ended_;
  }
  if (!decode) return ProceedFrom(digesting);
  computation_->Decode([self = shared_from_this()](const absl::Status& decoded) { self->OnDecoded(decoded); });
}

void VoxelizeReactor::OnDecoded(const absl::Status& status) {
  bool goes_on = false;
  {
    const std::lock_guard lock(mu_);
    decoding_ = false;
    if (!status.ok()) EndLocked(status);
    computing_ = goes_on = !ended_;
  }
  goes_on ? Enqueue() : Proceed();
}

void VoxelizeReactor::Enqueue() {
  queue().Enqueue([self = shared_from_this()] { self->Compute(); });
}

WorkQueue& VoxelizeReactor::queue() const { return computation_->IsLarge() ? environment_.bulk : environment_.quick; }

void VoxelizeReactor::Compute() {
  const absl::StatusOr<bool> done = ComputeSome();
  if (done.ok() && !*done && HasCredit()) return Enqueue();
  environment_.registry.Pause(this);  // before NextStep may ask for another turn
  {
    const std::lock_guard lock(mu_);
    computing_ = false;
    if (!done.ok()) {
      EndLocked(done.status());
    } else if (*done) {
      ended_ = true;
    } else {
      paused_ = true;
    }
  }
  ProceedFrom(queue());
}

bool VoxelizeReactor::HasCredit() {
  const std::lock_guard lock(mu_);
  return unwritten_bytes_ <= kCredit / 2;
}

absl::StatusOr<bool> VoxelizeReactor::ComputeSome() {
  const auto deliver = [this](v1::VoxelizeResponse&& response) { return Deliver(std::move(response)); };
  if (!std::exchange(started_, true)) {
    absl::Status status = computation_->Start(deliver);
    // Only now it is known how large the job is: it may go on in the other queue.
    return status.ok() ? absl::StatusOr<bool>(false) : status;
  }
  return computation_->Advance(deliver, [this] { return queue().contended(); });
}

bool VoxelizeReactor::Deliver(v1::VoxelizeResponse&& response) {
  bool more = false;
  {
    const std::lock_guard lock(mu_);
    unwritten_bytes_ += response.ByteSizeLong();
    outbox_.push_back(std::move(response));
    more = unwritten_bytes_ < kCredit;
  }
  ProceedFrom(queue());
  return more;
}

void VoxelizeReactor::OnWriteDone(bool ok) {
  {
    const std::lock_guard lock(mu_);
    writing_ = false;
    heard_of_client_ = Clock::now();
    unwritten_bytes_ -= writing_bytes_;
    if (ok) {
      bytes_out_ += writing_bytes_;
    } else {
      EndLocked(absl::CancelledError("the client is gone"));
    }
  }
  Proceed();
}

void VoxelizeReactor::End(const absl::Status& status) {
  {
    const std::lock_guard lock(mu_);
    EndLocked(status);
  }
  Proceed();
}

// The first error stands. It also replaces a success that the client has not been told yet.
void VoxelizeReactor::EndLocked(const absl::Status& status) {
  if (!status_.ok() || finishing_) return;
  ended_ = true;
  status_ = status;
  if (computation_) computation_->Cancel();
}

void VoxelizeReactor::EndIfStalled(absl::Duration patience) {
  absl::Status status = StalledClient(patience);
  bool stuck = false;
  {
    const std::lock_guard lock(mu_);
    const bool waits_for_client = reading_ || writing_ || finishing_;
    if (!waits_for_client || absl::FromChrono(Clock::now() - heard_of_client_) < patience) return;
    stuck = writing_ || finishing_;
    if (!status_.ok()) status = status_;
  }
  End(status);
  // What the client does not take ends in no other way.
  if (stuck) canceller_.Cancel(status);
}

VoxelizeReactor::Step VoxelizeReactor::NextStep() {
  const std::lock_guard lock(mu_);
  Step step;
  if (finishing_) return step;
  if (!status_.ok()) {
    outbox_.clear();
    // Their ends lead here again; a write that nobody takes must not keep the turn.
    step.pause = writing_ && !computing_;
    if (decoding_ || computing_ || writing_) return step;
    finishing_ = true;
    heard_of_client_ = Clock::now();
    step.send = Send::kStatus;
    return step;
  }
  // The summary, always the last message, leaves together with the status, once its task is over.
  if (!writing_ && !outbox_.empty() && (ended_ || !outbox_.front().has_summary())) {
    writing_ = true;
    heard_of_client_ = Clock::now();
    writing_message_ = std::move(outbox_.front());
    writing_bytes_ = writing_message_.ByteSizeLong();
    outbox_.pop_front();
    finishing_ = ended_ && outbox_.empty();
    if (finishing_) bytes_out_ += writing_bytes_;
    step.send = finishing_ ? Send::kLastMessageAndStatus : Send::kMessage;
  }
  if (paused_ && unwritten_bytes_ <= kCredit / 2) {
    paused_ = false;
    step.await_turn = true;
  }
  return step;
}

void VoxelizeReactor::Proceed() {
  const Step step = NextStep();
  if (step.send == Send::kLastMessageAndStatus || step.send == Send::kStatus) {
    // The client may take its time for the status.
    if (computation_) computation_->Free();
    environment_.registry.Vacate(this);
  }
  switch (step.send) {
    case Send::kNothing:
      break;
    case Send::kMessage:
      StartWrite(&writing_message_);
      break;
    case Send::kLastMessageAndStatus:
      StartWriteAndFinish(&writing_message_, grpc::WriteOptions(), grpc::Status::OK);
      break;
    case Send::kStatus:
      Finish(StatusForClient(status_, context_));
      break;
  }
  if (step.pause) environment_.registry.Pause(this);
  if (step.await_turn) environment_.registry.AwaitTurn(this);
}

void VoxelizeReactor::ProceedFrom(const WorkQueue& queue) {
  DoOrdinarily(queue, environment_.quick, [self = shared_from_this()] { self->Proceed(); });
}

// Nothing else runs any more: no callback, no task.
void VoxelizeReactor::OnDone() {
  canceller_.Over();
  RequestRecord record;
  record.origin = origin_;
  record.bytes_in = bytes_in_;
  {
    const std::lock_guard lock(mu_);
    record.status = sent_too_little_ && context_.IsCancelled() ? BrokenRead(environment_.limits) : status_;
    record.bytes_out = bytes_out_;
    record.upload_ms = upload_ms_;
    record.queue_ms = queue_ms_;
    if (computation_) {
      record.lattice = std::string{computation_->spec().grid.lattice.name()};
      record.separability = computation_->spec().request.separability;
      if (queue_ms_) record.work = computation_->facts();
    }
  }
  record.total_ms = MillisecondsSince(began_);
  LogRequest(record);
  environment_.metrics.Record(record);
  environment_.registry.Remove(this);
  self_.reset();
}

}  // namespace latvox
