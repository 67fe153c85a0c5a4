// The call Voxelize: gRPC's callbacks on one side, the compute arena on the other.
#ifndef LATVOX_SERVER_CALLS_VOXELIZE_REACTOR_H_
#define LATVOX_SERVER_CALLS_VOXELIZE_REACTOR_H_

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "latvox/v1/voxelizer.pb.h"
#include "server/access/call_origin.h"
#include "server/calls/call.h"
#include "server/calls/call_registry.h"
#include "server/work/call_environment.h"
#include "server/work/computation.h"
#include "server/work/mesh_upload.h"
#include "server/work/work_queue.h"

namespace latvox {

// Life of a call:
//   reading    spec, then pieces of the mesh, checked as they come            callbacks of gRPC
//   waiting    for its turn                                                   in the registry; no thread is held
//   computing  Computation::ReceiveMesh                                       a task
//   decoding   Computation::Decode                                            elsewhere; no thread of ours is held
//   computing  Computation::Start, then Advance again and again               tasks of a queue, one at a time
//   paused     kCredit bytes wait to be written; others have its turn         until half of them are written
//   waiting    for another turn                                               as before; then computing goes on
//   ended      a status is decided; Finish follows once no decode, task or write is under way
//
// Callbacks neither compute nor wait: mu_ is held for a few instructions only. One write at most is under way. The
// object owns itself until OnDone; a decode and a task of the arena hold a share of their own.
class VoxelizeReactor final : public grpc::ServerBidiReactor<v1::VoxelizeRequest, v1::VoxelizeResponse>,
                              public LiveCall,
                              public std::enable_shared_from_this<VoxelizeReactor> {
 public:
  // Bytes that may be finished but not yet written. gRPC and the kernel hold some 4 MiB more for a slow client.
  static constexpr size_t kCredit = size_t{4} << 20;

  VoxelizeReactor(grpc::CallbackServerContext& context, CallOrigin origin, const CallEnvironment& environment);

  // Starts to read if the registry admits the call, else refuses it. Once, before the reactor is handed to gRPC.
  void Begin();

  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnCancel() override { End(CancellationOf(context_)); }
  void OnDone() override;

  void Stop(const absl::Status& status) override { End(status); }
  void Work() override;
  void EndIfStalled(absl::Duration patience) override;

 private:
  using Clock = std::chrono::steady_clock;
  enum class Send { kNothing, kMessage, kLastMessageAndStatus, kStatus };

  // What the caller of NextStep must do after it has released mu_.
  struct Step {
    Send send = Send::kNothing;
    bool pause = false, await_turn = false;
  };

  void Read();
  absl::Status TakeRequest();
  absl::Status TakeSpec(const v1::VoxelizeSpec& proto);
  void FinishReading();
  absl::Status CheckUpload() const;
  void TakeMesh(const WorkQueue& digesting);
  void OnDecoded(const absl::Status& status);
  void Enqueue();
  WorkQueue& queue() const;
  void Compute();
  bool HasCredit();
  absl::StatusOr<bool> ComputeSome();
  bool Deliver(v1::VoxelizeResponse&& response);
  void End(const absl::Status& status);
  void EndLocked(const absl::Status& status);
  Step NextStep();
  void Proceed();
  void ProceedFrom(const WorkQueue& queue);

  grpc::CallbackServerContext& context_;
  CallCanceller canceller_;
  const CallEnvironment environment_;
  const CallOrigin origin_;
  const Clock::time_point began_ = Clock::now();
  std::shared_ptr<VoxelizeReactor> self_;

  // Used by whoever reads.
  v1::VoxelizeRequest request_;
  std::optional<MeshUpload> upload_;
  bool may_be_kept_ = false;  // the mesh; then none need come
  bool sent_too_little_ = false;
  uint64_t bytes_in_ = 0;

  v1::VoxelizeResponse writing_message_;  // the write under way; nobody touches it meanwhile

  std::mutex mu_;
  // All below is guarded by mu_; computation_ is set once, and then thread-safe by its own rules.
  std::unique_ptr<Computation> computation_;
  std::deque<v1::VoxelizeResponse> outbox_;
  size_t unwritten_bytes_ = 0;  // of outbox_ and writing_message_
  size_t writing_bytes_ = 0;    // of writing_message_
  uint64_t bytes_out_ = 0;
  std::optional<double> upload_ms_, queue_ms_;
  Clock::time_point waits_since_, heard_of_client_ = began_;
  bool reading_ = true;
  bool decoding_ = false, computing_ = false, writing_ = false;
  bool paused_ = false;     // has no turn, and awaits none yet
  bool started_ = false;    // Computation::Start has been called
  bool ended_ = false;      // status_ is decided; if it is OK, outbox_ still has to be written
  bool finishing_ = false;  // gRPC has been given the status: no operation may follow
  absl::Status status_;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_CALLS_VOXELIZE_REACTOR_H_
