// The state and the life that all kinds of calls share.
#ifndef LATVOX_SERVER_CALLS_CALL_STATE_H_
#define LATVOX_SERVER_CALLS_CALL_STATE_H_

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>
#include <grpcpp/support/status.h>

#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <type_traits>
#include <utility>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "core/base/stop_signal.h"
#include "server/access/call_origin.h"
#include "server/calls/call.h"
#include "server/calls/call_registry.h"
#include "server/calls/request_log.h"
#include "server/work/call_environment.h"
#include "server/work/work_lanes.h"
#include "server/work/work_queue.h"

namespace latvox {

// Life of a call:
//   Begin      checks that need no place, a place in the registry, then Start
//   Work       the registry gives a turn; a task works
//   End        a status is decided; once no task is at work, it is sent
//   OnDone     gRPC has no further callback: the call is recorded, and leaves the registry
//
// Lifetime:
//   gRPC      has a bare pointer; self_ holds a share for it, from Begin to OnDone
//   tasks     hold shares of their own, as a decode does; the registry does so until Remove
//   OnDone    is the last callback: gRPC calls it after Finish, and once every other callback has returned
// Finish follows the last task, but a thread that called Finish may outlive OnDone by a moment, with its share. The
// server may be gone by then. So OnDone gives the memory back before it leaves the registry, and self_ goes last.
//
// Locks: mu_ guards what callbacks, tasks and the registry share, for a few instructions.
//   under mu_       StartRead, so that no Finish comes in between; StopSource::Stop, Computation::Cancel and Receive.
//                   None of them calls back on this thread.
//   without mu_     Finish, and the registry, which may call Work of this very call. The registry in turn holds no lock
//                   when it calls Work, Stop or EndIfStalled.
class CallState : public LiveCall, public std::enable_shared_from_this<CallState> {
 public:
  // Call it once, before gRPC gets the reactor.
  void Begin();

  void Stop(const absl::Status& status) final { End(status); }
  // Here: for calls that receive, and then have one answer. A client that does not take it is cut off.
  void EndIfStalled(absl::Duration patience) override;

 protected:
  using Clock = std::chrono::steady_clock;

  CallState(grpc::CallbackServerContext& context, CallOrigin origin, const CallEnvironment& environment)
      : context_(context), canceller_(context), environment_(environment), origin_(std::move(origin)) {}

  // The parts that each kind of call adds.

  // Refuses a call before it has a place.
  virtual absl::Status Check() const { return absl::OkStatus(); }
  // The call has a place: reads, or awaits its turn.
  virtual void Start() = 0;
  // Called under mu_: whether it waits for the client to send.
  virtual bool IsReading() const { return false; }
  // Ends the call with `status`, unless it has one already. Here: the first status stands.
  virtual void End(const absl::Status& status);
  // Completes a record that has origin, status and queue_ms. No callback and no task runs any more.
  virtual void Describe(RequestRecord& record) const = 0;
  // Gives reserved memory back.
  virtual void Free() {}
  // gRPC's Finish.
  virtual void FinishWith(const grpc::Status& status) = 0;

  // For calls with a single task. BeginTask returns false if the call has ended; `ready` is when it became ready to
  // work. Call SendStatus after EndTask.
  bool BeginTask(Clock::time_point ready);
  void EndTask(const absl::Status& status);

  // Returns the queue for the client's large work, which the call holds from now on. Threads: one at a time.
  const std::shared_ptr<WorkQueue>& Bulk();

  // Sends the status. Precondition: it is final, and no task is at work.
  void SendStatus();
  // The body of OnDone.
  void Done();

  // A share of the call, for a task.
  template <class Call>
  static std::shared_ptr<Call> ShareOf(Call& call) {
    return std::static_pointer_cast<Call>(call.shared_from_this());
  }

  grpc::CallbackServerContext& context_;
  CallCanceller canceller_;
  const CallEnvironment environment_;
  const CallOrigin origin_;
  const Clock::time_point began_ = Clock::now();
  StopSource stop_;  // for the task

  std::mutex mu_;
  // All below is guarded by mu_.
  std::optional<double> queue_ms_;
  Clock::time_point heard_of_client_ = began_;
  bool working_ = false;    // a task
  bool finishing_ = false;  // status_ is final, and gRPC has it or is about to get it
  absl::Status status_;

 private:
  void SetFinishing();

  Clock::time_point finished_;  // guarded by mu_; when finishing_ was set, in calls that are one task
  std::shared_ptr<WorkQueue> lane_;
  std::shared_ptr<CallState> self_;
};

// A call as one of gRPC's server reactors. `Base` is CallState, or a class derived from it.
template <class Reactor, class Base = CallState>
class CallReactor : public Reactor, public Base {
 public:
  using GrpcReactor = Reactor;

  void OnCancel() final { this->End(CancellationOf(this->context_)); }
  void OnDone() final { this->Done(); }

  // gRPC calls OnDone and OnCancel of a stream on another thread, because they may take long. For an answer of one
  // message, it asks this function whether it may stay on its own thread. That saves a tenth of a small request's time.
  bool InternalInlineable() final { return std::is_same_v<Reactor, grpc::ServerUnaryReactor>; }

 protected:
  using Base::Base;

 private:
  void FinishWith(const grpc::Status& status) final { this->Finish(status); }
};

}  // namespace latvox

#endif  // LATVOX_SERVER_CALLS_CALL_STATE_H_
