// The call PutMesh: gRPC's callbacks on one side, a task of the compute arena on the other.
#ifndef LATVOX_SERVER_CALLS_PUT_MESH_REACTOR_H_
#define LATVOX_SERVER_CALLS_PUT_MESH_REACTOR_H_

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "core/base/stop_signal.h"
#include "latvox/v1/voxelizer.pb.h"
#include "server/access/call_origin.h"
#include "server/calls/call.h"
#include "server/calls/call_registry.h"
#include "server/decode/mesh_store.h"
#include "server/work/call_environment.h"
#include "server/work/memory_budget.h"
#include "server/work/mesh_upload.h"
#include "server/work/work_queue.h"

namespace latvox {

// Life of a call: spec, then pieces of the mesh, checked as they come; then a task that checks the digest and stores
// the mesh. The object owns itself until OnDone; the task holds a share of its own. Finish follows once a status is
// decided and the task is over.
class PutMeshReactor final : public grpc::ServerReadReactor<v1::PutMeshRequest>,
                             public LiveCall,
                             public std::enable_shared_from_this<PutMeshReactor> {
 public:
  // `response` lives until OnDone.
  PutMeshReactor(grpc::CallbackServerContext& context, v1::PutMeshResponse& response, CallOrigin origin,
                 const CallEnvironment& environment);

  // Starts to read if the registry admits the call, else refuses it. Once, before the reactor is handed to gRPC.
  void Begin();

  void OnReadDone(bool ok) override;
  void OnCancel() override { End(CancellationOf(context_)); }
  void OnDone() override;

  void Stop(const absl::Status& status) override { End(status); }
  void Work() override;
  void EndIfStalled(absl::Duration patience) override;

 private:
  using Clock = std::chrono::steady_clock;

  void Read();
  absl::StatusOr<bool> TakeRequest();
  absl::StatusOr<bool> TakeSpec(const v1::PutMeshSpec& spec);
  void FinishReading();
  absl::Status CheckUpload() const;
  absl::Status Store();
  void End(const absl::Status& status);
  void SendStatus();

  grpc::CallbackServerContext& context_;
  CallCanceller canceller_;
  v1::PutMeshResponse& response_;
  const CallEnvironment environment_;
  const CallOrigin origin_;
  const Clock::time_point began_ = Clock::now();
  std::shared_ptr<PutMeshReactor> self_;

  // Used by whoever reads, then by the task.
  v1::PutMeshRequest request_;
  MeshDigest digest_{};
  std::optional<MeshUpload> upload_;
  MemoryReservation memory_;
  bool sent_too_little_ = false;
  uint64_t bytes_in_ = 0;
  StopSource stop_;  // for the task

  std::mutex mu_;
  // All below is guarded by mu_.
  bool reading_ = true, working_ = false;
  bool finishing_ = false;  // status_ is final, and SendStatus called or about to be
  std::optional<double> upload_ms_, queue_ms_;
  Clock::time_point waits_since_, last_read_ = began_, finished_;
  absl::Status status_;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_CALLS_PUT_MESH_REACTOR_H_
