// The state and the life that all kinds of calls share.
#ifndef LATVOX_SERVER_CALLS_CALL_STATE_H_
#define LATVOX_SERVER_CALLS_CALL_STATE_H_

#include <grpcpp/server_context.h>
#include <grpcpp/support/status.h>

#include <chrono>
#include <memory>
#include <mutex>
#include <optional>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "core/base/stop_signal.h"
#include "server/access/call_origin.h"
#include "server/calls/call.h"
#include "server/calls/call_registry.h"
#include "server/calls/request_log.h"
#include "server/work/call_environment.h"
#include "server/work/work_queue.h"

namespace latvox {

// Life of a call:
//   Begin      checks that need no place, a place in the registry, then Start
//   Work       the registry gives a turn; a task works
//   End        a status is decided; once no task is at work, it is sent
//   OnDone     gRPC has no further callback: the call is recorded, and leaves the registry
//
// Lifetime: a call owns itself from Begin to OnDone, and each task holds a share of its own. So no callback and no task
// meets a dead object. After OnDone the server may be gone before this object is.
// Locks: mu_ guards the members that callbacks, tasks and the registry share. It is held for a few instructions only,
// and never while the registry or gRPC's Finish is called.
class CallState : public LiveCall, public std::enable_shared_from_this<CallState> {
 public:
  // Call it once, before gRPC gets the reactor.
  void Begin();

  void Stop(const absl::Status& status) final { End(status); }
  void EndIfStalled(absl::Duration patience) final;

 protected:
  using Clock = std::chrono::steady_clock;

  CallState(grpc::CallbackServerContext& context, CallOrigin origin, const CallEnvironment& environment)
      : context_(context), canceller_(context), environment_(environment), origin_(std::move(origin)) {}

  // The parts that each kind of call adds.

  // Refuses a call before it has a place.
  virtual absl::Status Check() const { return absl::OkStatus(); }
  // The call has a place: reads, or awaits its turn.
  virtual void Start() = 0;
  // Called under mu_: whether it waits for the client to send, and for the client to take a message.
  virtual bool IsReading() const { return false; }
  virtual bool IsWriting() const { return false; }
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
  Clock::time_point heard_of_client_ = began_;  // or when it got something to take
  bool working_ = false;                        // a task
  bool finishing_ = false;                      // status_ is final, and gRPC has it or will get it at once
  absl::Status status_;

 private:
  void SetFinishing();

  std::shared_ptr<CallState> self_;
};

// A call as one of gRPC's server reactors.
template <class Reactor>
class CallReactor : public Reactor, public CallState {
 public:
  void OnCancel() final { End(CancellationOf(context_)); }
  void OnDone() final { Done(); }

 protected:
  using CallState::CallState;

 private:
  void FinishWith(const grpc::Status& status) final { this->Finish(status); }
};

}  // namespace latvox

#endif  // LATVOX_SERVER_CALLS_CALL_STATE_H_
