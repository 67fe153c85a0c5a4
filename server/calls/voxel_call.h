// A call that voxelizes, whatever way its mesh comes and its answer goes: gRPC's callbacks on one side, the compute
// arena on the other.
#ifndef LATVOX_SERVER_CALLS_VOXEL_CALL_H_
#define LATVOX_SERVER_CALLS_VOXEL_CALL_H_

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "latvox/v1/voxelizer.pb.h"
#include "server/calls/mesh_call.h"
#include "server/work/computation.h"

namespace latvox {

// Life of a call:
//   reading    spec, then pieces of the mesh, checked as they come            callbacks of gRPC
//   waiting    for its turn                                                   in the registry; no thread is held
//   computing  Computation::ReceiveMesh                                       a task, or the callback of a tiny job
//   decoding   Computation::Decode                                            elsewhere; no thread of ours is held
//   computing  Computation::Measure and Start, then Advance again and again   tasks of a queue, one at a time
//   paused     kCredit bytes wait to be written; others have its turn         until half of them are written
//   waiting    for another turn                                               as before; then computing goes on
//   ended      a status is decided; Finish follows once no decode, task or write is under way
//
// Callbacks do not wait. They compute only tiny jobs: by the estimate, of some tenths of a millisecond. The way to
// other threads and back costs a tenth of these. So one thread computes all of a tiny job, be it a callback's or the
// queue's, and its messages leave at the end. One write at most is under way. A decode holds a share of the object, as
// a task does.
class VoxelCall : public MeshCall {
 public:
  // Bytes of finished messages that may wait for their write. gRPC and the kernel hold some 4 MiB more for a slow
  // client.
  static constexpr size_t kCredit = size_t{4} << 20;

  void Work() override;
  void WorkHere() override;
  void Oversee() override;
  void EndIfStalled(absl::Duration patience) override;

 protected:
  using MeshCall::MeshCall;

  // The parts that each kind of call adds.

  // Starts to write. Written follows, possibly at once. `more`: another message follows as soon as this is written.
  virtual void Write(v1::VoxelizeResponse& message, bool more) = 0;
  // Writes, and finishes the call with OK.
  virtual void WriteLast(v1::VoxelizeResponse& message) = 0;
  // Returns an error if the answer may not have so many bytes, in all messages so far. Called under mu_.
  virtual absl::Status AdmitAnswer(uint64_t /*bytes*/) { return absl::OkStatus(); }

  // Takes the specification, then the pieces of the mesh. Errors: as the contract.
  absl::Status TakeSpec(const v1::VoxelizeSpec& proto);
  absl::Status TakePiece(std::string&& piece);

  // A write is over. `ok` is false if the client is gone.
  void Written(bool ok);

  bool has_ended() const { return ended_; }  // called under mu_
  absl::Status CheckUpload() const override;
  void End(const absl::Status& status) override;
  void Describe(RequestRecord& record) const override;

 private:
  enum class Send { kNothing, kMessage, kLastMessageAndStatus, kStatus };

  // The actions of NextStep's caller after it has released mu_.
  struct Step {
    Send send = Send::kNothing;
    bool more = false;  // another message follows a kMessage
    bool pause = false, await_turn = false;
  };

  WorkQueue& QueueOfJob();
  bool GoesOn(const WorkQueue& queue);
  void BeginWork(bool here);
  void HandleMesh(const WorkQueue& digesting);
  void Decode();
  void OnDecoded(const absl::Status& status);
  void Enqueue();
  void Compute(const WorkQueue& queue);
  bool HasCredit();
  absl::StatusOr<bool> ComputeSome(const WorkQueue& queue);
  bool Deliver(v1::VoxelizeResponse&& response, const WorkQueue& queue);
  void EndLocked(const absl::Status& status);
  Step NextStep();
  void Proceed();
  void ProceedFrom(const WorkQueue& queue);

  std::optional<RawMeshCheck> raw_mesh_;  // of the pieces, if they are plain arrays
  bool may_be_kept_ = false;              // a mesh that may be stored: it need not be sent
  v1::VoxelizeResponse writing_message_;  // the write under way; no thread touches it meanwhile
  // Whether the job seems tiny. Then one thread computes all of it, and sends the messages at the end. Only the thread
  // that computes touches this.
  bool alone_ = false;

  // All below is guarded by mu_. computation_ is set once, and has its own rules for threads.
  std::unique_ptr<Computation> computation_;
  std::deque<v1::VoxelizeResponse> outbox_;
  size_t unwritten_bytes_ = 0;  // of outbox_ and writing_message_
  size_t writing_bytes_ = 0;    // of writing_message_
  uint64_t answer_bytes_ = 0;   // of all messages so far
  uint64_t bytes_out_ = 0;      // of the messages that were written
  bool decoding_ = false, writing_ = false;
  bool paused_ = false;                      // has no turn, and does not await one yet
  bool measured_ = false, started_ = false;  // Computation::Measure, Start has been called; of the tasks
  bool ended_ = false;                       // status_ is decided; if it is OK, outbox_ still has to be written
};

// Writes as one of gRPC's streaming reactors does.
template <class Reactor>
class StreamedAnswer : public Reactor {
 public:
  void OnWriteDone(bool ok) final { this->Written(ok); }

 private:
  // With the hint, gRPC sends a small message together with the next one. The first message would wait for ever,
  // because its write is over once the initial metadata are sent, which the hint delays as well.
  void Write(v1::VoxelizeResponse& message, bool more) final {
    const bool waits = std::exchange(has_begun_, true) && more;
    this->StartWrite(&message, waits ? grpc::WriteOptions().set_buffer_hint() : grpc::WriteOptions());
  }
  void WriteLast(v1::VoxelizeResponse& message) final {
    this->StartWriteAndFinish(&message, grpc::WriteOptions(), grpc::Status::OK);
  }

  bool has_begun_ = false;  // one write at a time uses it

 protected:
  using Reactor::Reactor;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_CALLS_VOXEL_CALL_H_
