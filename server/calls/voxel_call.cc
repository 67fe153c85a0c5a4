#include "server/calls/voxel_call.h"

#include <oneapi/tbb/task_arena.h>

#include <atomic>
#include <utility>

#include "server/base/milliseconds.h"

namespace latvox {
namespace {

// To digest or copy it takes a tenth of a millisecond.
constexpr uint64_t kTinyMeshBytes = uint64_t{64} << 10;

// One of gRPC's threads may compute at a time, because all calls share these: two or more.
class ComputingHere {
 public:
  ComputingHere() : is_alone_(!busy_.exchange(true)) {}
  ~ComputingHere() {
    if (is_alone_) busy_ = false;
  }
  ComputingHere(const ComputingHere&) = delete;
  ComputingHere& operator=(const ComputingHere&) = delete;

  bool is_alone() const { return is_alone_; }

 private:
  static inline std::atomic<bool> busy_ = false;
  const bool is_alone_;
};

// Runs act() so that its parallel algorithms wake no other thread.
template <class F>
void RunAlone(F act) {
  thread_local oneapi::tbb::task_arena alone(1, 1);
  alone.execute(std::move(act));
}

}  // namespace

absl::Status VoxelCall::TakeSpec(const v1::VoxelizeSpec& proto) {
  absl::StatusOr<JobSpec> spec = JobSpecFromProto(proto, environment_.limits);
  if (!spec.ok()) return spec.status();
  upload_.emplace(spec->mesh_bytes, environment_.limits.max_mesh_bytes);
  may_be_kept_ = spec->mesh_digest.has_value();
  if (spec->raw_mesh) raw_mesh_.emplace(*spec->raw_mesh);
  // The whole mesh must fit, but its memory counts only as it comes, so that a mere announcement takes none.
  if (spec->mesh_bytes > environment_.memory.total()) {
    return LimitExceeded("memory", spec->mesh_bytes, environment_.memory.total());
  }
  auto computation = std::make_unique<Computation>(*std::move(spec), origin_.request_id, environment_);
  // The call may end on another thread at any time. That thread then frees a computation that is there, without mu_.
  const std::lock_guard lock(mu_);
  if (!finishing_) computation_ = std::move(computation);
  return absl::OkStatus();
}

// A piece that is refused is counted, too.
absl::Status VoxelCall::TakePiece(std::string&& piece) {
  absl::Status status = raw_mesh_ ? raw_mesh_->Add(piece) : absl::OkStatus();
  status.Update(upload_->Append(std::move(piece)));
  bytes_in_ = upload_->size();
  if (!status.ok()) return status;
  const std::lock_guard lock(mu_);
  return finishing_ ? absl::OkStatus() : computation_->Receive(bytes_in_);
}

absl::Status VoxelCall::CheckUpload() const {
  return may_be_kept_ && upload_->size() == 0 ? absl::OkStatus() : upload_->CheckComplete();
}

void VoxelCall::Work() { BeginWork(/*here=*/false); }

void VoxelCall::WorkHere() {
  const ComputingHere computing;
  BeginWork(computing.is_alone());
}

void VoxelCall::BeginWork(bool here) {
  {
    const std::lock_guard lock(mu_);
    if (ended_) return;
    if (!queue_ms_) queue_ms_ = MillisecondsSince(ready());
    working_ = true;
  }
  alone_ = upload_ && upload_->size() <= kTinyMeshBytes;
  if (!upload_) return Enqueue();
  WorkQueue& digesting = upload_->size() > kLargeMeshBytes ? *Bulk() : environment_.quick;
  const auto handle = [self = ShareOf(*this), &digesting] { self->HandleMesh(digesting); };
  if (!alone_) return digesting.Enqueue(handle);
  here ? RunAlone(handle) : digesting.Enqueue([handle] { RunAlone(handle); });
}

void VoxelCall::HandleMesh(const WorkQueue& digesting) {
  const absl::Status status = computation_->ReceiveMesh(*std::exchange(upload_, std::nullopt));
  bool decode = false;
  {
    const std::lock_guard lock(mu_);
    working_ = false;
    if (!status.ok()) EndLocked(status);
    decoding_ = decode = !ended_;
  }
  if (!decode) return ProceedFrom(digesting);
  const uint64_t bytes = computation_->mesh_bytes();  // the mesh may be a stored one
  if (!alone_ || bytes <= kTinyMeshBytes) return Decode();
  alone_ = false;
  WorkQueue& decoding = bytes > kLargeMeshBytes ? *Bulk() : environment_.quick;
  decoding.Enqueue([self = ShareOf(*this)] { self->Decode(); });
}

void VoxelCall::Decode() {
  if (const auto decoded = computation_->DecodeAtOnce()) return OnDecoded(*decoded);
  alone_ = false;
  computation_->Decode([self = ShareOf(*this)](const absl::Status& decoded) { self->OnDecoded(decoded); });
}

void VoxelCall::OnDecoded(const absl::Status& status) {
  bool goes_on = false;
  {
    const std::lock_guard lock(mu_);
    decoding_ = false;
    if (!status.ok()) EndLocked(status);
    working_ = goes_on = !ended_;
  }
  goes_on ? Enqueue() : Proceed();
}

WorkQueue& VoxelCall::QueueOfJob() { return computation_->IsLarge() ? *Bulk() : environment_.quick; }

void VoxelCall::Enqueue() {
  WorkQueue& queue = QueueOfJob();
  if (alone_ && computation_->IsTiny()) return Compute(queue);
  if (std::exchange(alone_, false)) Proceed();
  queue.Enqueue([self = ShareOf(*this), &queue] { self->Compute(queue); });
}

// Whether the next step follows at once on this thread.
bool VoxelCall::GoesOn(const WorkQueue& queue) {
  if (alone_) return computation_->IsTiny();
  return &QueueOfJob() == &queue && !queue.contended();
}

void VoxelCall::Compute(const WorkQueue& queue) {
  absl::StatusOr<bool> done = ComputeSome(queue);
  while (done.ok() && !*done && HasCredit()) {
    if (!GoesOn(queue)) return Enqueue();
    done = ComputeSome(queue);
  }
  environment_.registry.Pause(this);  // before NextStep may ask for another turn
  {
    const std::lock_guard lock(mu_);
    working_ = false;
    if (!done.ok()) {
      EndLocked(done.status());
    } else if (*done) {
      ended_ = true;
    } else {
      paused_ = true;
    }
  }
  ProceedFrom(queue);
}

bool VoxelCall::HasCredit() {
  const std::lock_guard lock(mu_);
  return unwritten_bytes_ <= kCredit / 2;
}

absl::StatusOr<bool> VoxelCall::ComputeSome(const WorkQueue& queue) {
  if (!std::exchange(measured_, true)) {
    const bool was_large = computation_->IsLarge();
    if (absl::Status status = computation_->Measure(); !status.ok()) return status;
    const bool leaves = alone_ && !computation_->IsTiny();
    if (leaves || computation_->IsLarge() != was_large) return false;  // it goes on elsewhere
  }
  const auto deliver = [&](v1::VoxelizeResponse&& response) { return Deliver(std::move(response), queue); };
  if (!std::exchange(started_, true)) {
    absl::Status status = computation_->Start(deliver);
    return status.ok() ? absl::StatusOr<bool>(false) : status;
  }
  return computation_->Advance(deliver, [&] { return alone_ || queue.contended(); });
}

bool VoxelCall::Deliver(v1::VoxelizeResponse&& response, const WorkQueue& queue) {
  bool more = false;
  {
    const size_t bytes = response.ByteSizeLong();
    const std::lock_guard lock(mu_);
    answer_bytes_ += bytes;
    EndLocked(AdmitAnswer(answer_bytes_));
    unwritten_bytes_ += bytes;
    outbox_.push_back(std::move(response));
    more = status_.ok() && unwritten_bytes_ < kCredit;
  }
  if (!alone_) ProceedFrom(queue);
  return more;
}

void VoxelCall::Written(bool ok) {
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

void VoxelCall::End(const absl::Status& status) {
  {
    const std::lock_guard lock(mu_);
    EndLocked(status);
  }
  Proceed();
}

// The first error stands. It also replaces a success that the client has not been told yet.
void VoxelCall::EndLocked(const absl::Status& status) {
  if (status.ok() || !status_.ok() || finishing_) return;
  ended_ = true;
  status_ = status;
  if (computation_) computation_->Cancel();
}

void VoxelCall::Oversee() {
  {
    const std::lock_guard lock(mu_);
    if (!computation_ || ended_ || finishing_) return;
    const absl::Status status = computation_->Oversee();
    if (status.ok()) return;
    EndLocked(status);
  }
  Proceed();
}

// One clock runs from the last read, the last write, and the status. A status that already ends the call is the one
// that the client gets.
void VoxelCall::EndIfStalled(absl::Duration patience) {
  absl::Status status = StalledClient(patience);
  bool stuck = false;
  {
    const std::lock_guard lock(mu_);
    stuck = writing_ || finishing_;
    if (!(stuck || IsReading()) || absl::FromChrono(Clock::now() - heard_of_client_) < patience) return;
    if (!status_.ok()) status = status_;
  }
  End(status);
  // A message that the client does not take ends in no other way.
  if (stuck) canceller_.Cancel(status);
}

VoxelCall::Step VoxelCall::NextStep() {
  const std::lock_guard lock(mu_);
  Step step;
  if (finishing_) return step;
  if (!status_.ok()) {
    outbox_.clear();
    // The ends of these lead here again. A write that the client does not take must not keep the turn.
    step.pause = writing_ && !working_;
    if (decoding_ || working_ || writing_) return step;
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
    step.more = !outbox_.empty() && (ended_ || !outbox_.front().has_summary());
  }
  if (paused_ && unwritten_bytes_ <= kCredit / 2) {
    paused_ = false;
    step.await_turn = true;
  }
  return step;
}

void VoxelCall::Proceed() {
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
      Write(writing_message_, step.more);
      break;
    case Send::kLastMessageAndStatus:
      WriteLast(writing_message_);
      break;
    case Send::kStatus:
      FinishWith(StatusForClient(status_, context_));
      break;
  }
  if (step.pause) environment_.registry.Pause(this);
  if (step.await_turn) environment_.registry.AwaitTurn(this);
}

void VoxelCall::ProceedFrom(const WorkQueue& queue) {
  DoOrdinarily(queue, environment_.quick, [self = ShareOf(*this)] { self->Proceed(); });
}

void VoxelCall::Describe(RequestRecord& record) const {
  MeshCall::Describe(record);
  record.bytes_out = bytes_out_;
  if (!computation_) return;
  record.lattice = std::string{computation_->spec().grid.lattice.name()};
  record.separability = computation_->spec().request.separability;
  if (queue_ms_) record.work = computation_->facts();
}

}  // namespace latvox
