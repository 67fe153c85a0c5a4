// The calls in progress: their admission, their turns, and the drain when the server stops.
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
  // The call's turn has come, the first or another. Returns at once.
  virtual void Work() = 0;
  // Does the same on the thread that has just called AwaitTurn for this call. It may compute for a moment.
  virtual void WorkHere() { Work(); }
  // Called every few milliseconds while the call works. Ends it if its job has used up its time.
  virtual void Oversee() {}
  // Called regularly. Ends the call if its client has sent and taken next to nothing for `patience`.
  virtual void EndIfStalled(absl::Duration patience) = 0;
};

struct CallLimits {
  uint32_t max_jobs = 0;             // at work at once
  uint32_t max_queued_jobs = 0;      // that receive their input, wait for their turn, or are paused
  uint32_t max_jobs_per_client = 0;  // both kinds, for one client
};

// Thread-safe. A call is admitted, receives its input, waits for its turn, works, and vacates its place. In between it
// may pause and wait for another turn, as often as it likes, because it keeps its place.
//
// The client with the fewest calls at work gets the next turn. Among its calls, and among equal clients, turns
// alternate between a new call and a returning one. With one queue for all, a stream would wait as long as a new call
// at each of its pauses. With returning calls first, many streams would shut new calls out. Within each kind, the call
// that has waited longest is next.
class CallRegistry {
 public:
  explicit CallRegistry(const CallLimits& limits) : limits_(limits) {}

  // Takes a share in `call` of `client`, until Remove. Errors, all with a retry delay: RESOURCE_EXHAUSTED if there are
  // too many calls, or too many of this client; UNAVAILABLE after Close.
  //   max_jobs_of_client   this client's own limit, if it is lower than that of all clients; 0: it has none
  absl::Status Admit(std::shared_ptr<LiveCall> call, const std::string& client, uint32_t max_jobs_of_client = 0);

  // The call is ready to work. Calls Work() once its turn has come, possibly at once. Call it once for each call, and
  // once after each Pause.
  void AwaitTurn(const LiveCall* call);

  // The call has nothing to do until its client takes the messages so far. Another call gets its turn, or its place in
  // the line.
  void Pause(const LiveCall* call);

  // The call's work is over, and only its status has to reach the client: its place is free. Call it before the client
  // can see the status, so that a client with max_jobs calls at a time is never refused.
  void Vacate(const LiveCall* call);

  // The call is over. Ignores a call that was not admitted.
  void Remove(const LiveCall* call);

  // Admits no more calls, and stops calls that wait for their first turn, now or later.
  void Close();

  // Stops all calls with UNAVAILABLE and a retry delay.
  void StopAll();

  void EndStalled(absl::Duration patience);
  void Oversee();

  // Blocks until a call works, for `timeout`, or until Close.
  void WaitForWork(absl::Duration timeout);

  // Blocks until no call is in progress, or for `timeout`; returns whether none is. Do not use it on gRPC's threads.
  bool WaitUntilEmpty(absl::Duration timeout);

  // The numbers of calls in progress; at work; receiving input or waiting for a turn; paused.
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
    uint64_t ticket = 0;  // the order in the line
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
  void GiveTurns(const LiveCall* asking = nullptr);
  void StopWaitingIfClosed();
  template <class F>
  Calls Select(const F& wanted) const;

  const CallLimits limits_;
  mutable std::mutex mu_;
  std::condition_variable empty_, works_;
  // All below is guarded by mu_.
  std::unordered_map<const LiveCall*, Entry> calls_;
  std::unordered_map<std::string, Client> clients_;  // clients with jobs
  std::array<uint32_t, kStates> counts_{};           // the number of calls in each state
  uint64_t tickets_ = 0;
  bool new_is_next_ = false;  // a new call is next, rather than a returning one
  bool closed_ = false;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_CALLS_CALL_REGISTRY_H_
