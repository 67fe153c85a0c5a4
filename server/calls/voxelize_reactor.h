// The call Voxelize: gRPC's callbacks on one side, the compute arena on the other.
#ifndef LATVOX_SERVER_CALLS_VOXELIZE_REACTOR_H_
#define LATVOX_SERVER_CALLS_VOXELIZE_REACTOR_H_

#include <grpcpp/support/server_callback.h>

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "latvox/v1/voxelizer.pb.h"
#include "server/calls/upload_call.h"
#include "server/work/computation.h"

namespace latvox {

// Life of a call:
//   reading    spec, then pieces of the mesh, checked as they come            callbacks of gRPC
//   waiting    for its turn                                                   in the registry; no thread is held
//   computing  Computation::ReceiveMesh                                       a task
//   decoding   Computation::Decode                                            elsewhere; no thread of ours is held
//   computing  Computation::Measure and Start, then Advance again and again   tasks of a queue, one at a time
//   paused     kCredit bytes wait to be written; others have its turn         until half of them are written
//   waiting    for another turn                                               as before; then computing goes on
//   ended      a status is decided; Finish follows once no decode, task or write is under way
//
// Callbacks neither compute nor wait. One write at most is under way. A decode holds a share of the object, as a task
// does.
class VoxelizeReactor final
    : public UploadCall<grpc::ServerBidiReactor<v1::VoxelizeRequest, v1::VoxelizeResponse>, v1::VoxelizeRequest> {
 public:
  // Bytes of finished messages that may wait for their write. gRPC and the kernel hold some 4 MiB more for a slow
  // client.
  static constexpr size_t kCredit = size_t{4} << 20;

  VoxelizeReactor(grpc::CallbackServerContext& context, CallOrigin origin, const CallEnvironment& environment)
      : UploadCall(context, std::move(origin), environment) {}

  void OnWriteDone(bool ok) override;
  void Work() override;
  void Oversee() override;
  void EndIfStalled(absl::Duration patience) override;

 private:
  enum class Send { kNothing, kMessage, kLastMessageAndStatus, kStatus };

  // The actions of NextStep's caller after it has released mu_.
  struct Step {
    Send send = Send::kNothing;
    bool pause = false, await_turn = false;
  };

  absl::StatusOr<bool> ReceiveSpec(const v1::VoxelizeSpec& proto) override;
  absl::Status ReceivePiece(std::string&& piece) override;
  absl::Status CheckUpload() const override;
  bool HasEnded() const override { return ended_; }
  void End(const absl::Status& status) override;
  void Describe(RequestRecord& record) const override;

  void HandleMesh(const WorkQueue& digesting);
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

  // All below is guarded by mu_. computation_ is set once, and has its own rules for threads.
  std::unique_ptr<Computation> computation_;
  std::deque<v1::VoxelizeResponse> outbox_;
  size_t unwritten_bytes_ = 0;  // of outbox_ and writing_message_
  size_t writing_bytes_ = 0;    // of writing_message_
  uint64_t bytes_out_ = 0;
  bool decoding_ = false, writing_ = false;
  bool paused_ = false;                      // has no turn, and does not await one yet
  bool measured_ = false, started_ = false;  // Computation::Measure, Start has been called; of the tasks
  bool ended_ = false;                       // status_ is decided; if it is OK, outbox_ still has to be written
};

}  // namespace latvox

#endif  // LATVOX_SERVER_CALLS_VOXELIZE_REACTOR_H_
