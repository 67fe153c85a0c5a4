// The calls in progress: admission before work starts, and the drain when the server stops.
#ifndef LATVOX_SERVER_CALL_REGISTRY_H_
#define LATVOX_SERVER_CALL_REGISTRY_H_

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <unordered_set>

#include "absl/status/status.h"
#include "absl/time/time.h"

namespace latvox {

class LiveCall {
 public:
  virtual ~LiveCall() = default;
  // Ends the call early with `status`. Returns at once; the call leaves the registry when it is over.
  virtual void Stop(const absl::Status& status) = 0;
};

// Thread-safe.
class CallRegistry {
 public:
  explicit CallRegistry(uint32_t max_jobs) : max_jobs_(max_jobs) {}

  // Takes a share in `call` until Remove. Errors, both with a retry delay: RESOURCE_EXHAUSTED if max_jobs calls are in
  // progress, UNAVAILABLE after Close.
  absl::Status Admit(std::shared_ptr<LiveCall> call);

  // The call's work is over and only its status has to reach the client: its place is free. Before the client can know
  // the status, so that one which runs max_jobs calls at a time is never refused.
  void Vacate(const LiveCall* call);

  // The call is over. Does nothing for a call that was not admitted.
  void Remove(const LiveCall* call);

  // Admits no more calls.
  void Close();

  // Stops all calls, as UNAVAILABLE with a retry delay.
  void StopAll();

  // Blocks until no call is in progress, or for `timeout`; returns whether none is. Not for gRPC's threads.
  bool WaitUntilEmpty(absl::Duration timeout);

  size_t size() const;

 private:
  const uint32_t max_jobs_;
  mutable std::mutex mu_;
  std::condition_variable empty_;
  // All below is guarded by mu_.
  std::unordered_map<const LiveCall*, std::shared_ptr<LiveCall>> calls_;
  std::unordered_set<const LiveCall*> jobs_;  // those of calls_ that have not vacated their place
  bool closed_ = false;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_CALL_REGISTRY_H_
