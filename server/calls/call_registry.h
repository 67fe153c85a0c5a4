// The calls in progress: admission before work starts, whose turn it is, and the drain when the server stops.
#ifndef LATVOX_SERVER_CALLS_CALL_REGISTRY_H_
#define LATVOX_SERVER_CALLS_CALL_REGISTRY_H_

#include <array>
#include <condition_variable>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include "absl/status/status.h"
#include "absl/time/time.h"

namespace latvox {

class LiveCall {
 public:
  virtual ~LiveCall() = default;
  // Ends the call early with `status`. Returns at once; the call leaves the registry when it is over.
  virtual void Stop(const absl::Status& status) = 0;
  // The turn that the call has waited for has come, the first or another. Returns at once.
  virtual void Work() = 0;
  // Comes now and then. Ends the call if its client has neither sent nor taken anything for `patience`.
  virtual void EndIfStalled(absl::Duration patience) = 0;
};

struct CallLimits {
  uint32_t max_jobs = 0;             // at work at once
  uint32_t max_queued_jobs = 0;      // that receive their input, wait for their turn, or are paused
  uint32_t max_jobs_per_client = 0;  // either, of one client
};

// Thread-safe. A call is admitted, receives its input, waits for its turn, works, and vacates its place; in between it
// may pause and wait for another turn, as often as it likes, for it keeps its place. Turns are given to the client that
// has the fewest calls at work. Of its calls, and among equals, now to one that is new, now to one that comes back: at
// the end of one line for all, a stream would wait at each of its pauses as long as a new call; in a line before all,
// many streams would shut new calls out. Of either kind the one that waits longest is next.
class CallRegistry {
 public:
  explicit CallRegistry(const CallLimits& limits) : limits_(limits) {}

  // Takes a share in `call`, which is `client`'s, until Remove. Errors, all with a retry delay: RESOURCE_EXHAUSTED if
  // there are too many calls, or too many of this client; UNAVAILABLE after Close.
  //   max_jobs_of_client   of this very client, if it is less than that of all; 0: it is not
  absl::Status Admit(std::shared_ptr<LiveCall> call, const std::string& client, uint32_t max_jobs_of_client = 0);

  // The call is ready to work: has Work() called once its turn has come, which may be at once. Once for each call, and
  // once after each Pause.
  void AwaitTurn(const LiveCall* call);

  // The call has nothing to do until its client has taken what there is: its turn, if it has or awaits one, is
  // another's.
  void Pause(const LiveCall* call);

  // The call's work is over and only its status has to reach the client: its place is free. Before the client can know
  // the status, so that one which runs max_jobs calls at a time is never refused.
  void Vacate(const LiveCall* call);

  // The call is over. Does nothing for a call that was not admitted.
  void Remove(const LiveCall* call);

  // Admits no more calls, and stops those that wait for their first turn, now or later.
  void Close();

  // Stops all calls, as UNAVAILABLE with a retry delay.
  void StopAll();

  void EndStalled(absl::Duration patience);

  // Blocks until no call is in progress, or for `timeout`; returns whether none is. Not for gRPC's threads.
  bool WaitUntilEmpty(absl::Duration timeout);

  // Calls in progress; of these, at work; those that receive their input or wait for their turn; and those paused.
  size_t size() const;
  size_t working() const;
  size_t queued() const;
  size_t paused() const;

 private:
  enum State { kReceiving, kWaiting, kWorking, kPaused, kReturning, kVacated, kStates };
  struct Entry {
    std::shared_ptr<LiveCall> call;
    std::string client;
    State state = kReceiving;
    uint64_t ticket = 0;  // the order of waiting
  };
  struct Client {
    uint32_t jobs = 0, working = 0;
  };
  using Calls = std::vector<std::shared_ptr<LiveCall>>;

  absl::Status CheckRoom(const std::string& client, uint32_t max_jobs_of_client) const;
  size_t Count(std::initializer_list<State> states) const;
  void Move(Entry& entry, State state);
  void VacateLocked(Entry& entry);
  std::shared_ptr<LiveCall> NextTurnLocked();
  void GiveTurns();
  void StopWaitingIfClosed();
  template <class F>
  Calls Select(const F& wanted) const;

  const CallLimits limits_;
  mutable std::mutex mu_;
  std::condition_variable empty_;
  // All below is guarded by mu_.
  std::unordered_map<const LiveCall*, Entry> calls_;
  std::unordered_map<std::string, Client> clients_;  // those that have jobs
  std::array<uint32_t, kStates> counts_{};           // of calls in each state
  uint64_t tickets_ = 0;
  bool new_is_next_ = false;  // rather than one that comes back
  bool closed_ = false;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_CALLS_CALL_REGISTRY_H_
