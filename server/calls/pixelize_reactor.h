// The call Pixelize: gRPC's callbacks on one side, a task of the compute arena on the other.
#ifndef LATVOX_SERVER_CALLS_PIXELIZE_REACTOR_H_
#define LATVOX_SERVER_CALLS_PIXELIZE_REACTOR_H_

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
#include "server/work/call_environment.h"
#include "server/work/memory_budget.h"
#include "server/work/pixelization.h"
#include "server/work/work_queue.h"

namespace latvox {

// The object owns itself until OnDone; the task of the arena holds a share of its own. Finish follows once a status is
// decided and the task is over, for until then the task reads the request and writes the response, which are gRPC's.
class PixelizeReactor final : public grpc::ServerUnaryReactor,
                              public LiveCall,
                              public std::enable_shared_from_this<PixelizeReactor> {
 public:
  // `request` and `response` live until OnDone.
  PixelizeReactor(grpc::CallbackServerContext& context, const v1::PixelizeRequest& request,
                  v1::PixelizeResponse& response, CallOrigin origin, const CallEnvironment& environment);

  // Has the answer computed if the registry admits the call, else refuses it. Once, before the reactor is handed to
  // gRPC.
  void Begin();

  void OnCancel() override { End(CancellationOf(context_)); }
  void OnDone() override;

  void Stop(const absl::Status& status) override { End(status); }
  void Work() override;
  void EndIfStalled(absl::Duration patience) override;

 private:
  using Clock = std::chrono::steady_clock;

  void Compute();
  void End(const absl::Status& status);
  void SendStatus();

  grpc::CallbackServerContext& context_;
  CallCanceller canceller_;
  const v1::PixelizeRequest& request_;
  v1::PixelizeResponse& response_;
  const CallEnvironment environment_;
  const CallOrigin origin_;
  const uint64_t bytes_in_;
  const Clock::time_point began_ = Clock::now();
  std::shared_ptr<PixelizeReactor> self_;

  // The task's, until it is over.
  PixelizationFacts facts_;
  MemoryReservation memory_;
  uint64_t bytes_out_ = 0;

  StopSource stop_;
  std::mutex mu_;
  // All below is guarded by mu_.
  std::optional<double> queue_ms_;
  Clock::time_point finished_;
  bool computing_ = false;
  bool finishing_ = false;  // status_ is final, and SendStatus called or about to be
  absl::Status status_;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_CALLS_PIXELIZE_REACTOR_H_
