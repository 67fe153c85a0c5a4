// Stopping a call from anywhere.
#ifndef LATVOX_LATVOX_CANCELLATION_H_
#define LATVOX_LATVOX_CANCELLATION_H_

#include <functional>
#include <memory>

#include "latvox/export.h"

namespace latvox::client {

// A handle on one cancellation; copies share it. Cancelling is final and may come before, during or after the call
// that it is given to. Threads: every method may be called from any thread, and from the call's own callbacks. Not
// from a signal handler.
class LATVOX_EXPORT Cancellation {
 public:
  Cancellation();  // a new one, not cancelled

  // Stops every call that has it. Returns before they have ended.
  void Cancel() const;

  // Whether Cancel was called.
  bool cancelled() const;

  // While it lives, `action` runs on Cancel, at once if that has come already. Its destructor waits for a running
  // action. The action must not use this Cancellation.
  class Subscription {
   public:
    Subscription(const Cancellation& cancellation, std::function<void()> action);  // begins to listen
    ~Subscription();                                                               // no action runs after it
    Subscription(const Subscription&) = delete;                                    // one place, one action
    Subscription& operator=(const Subscription&) = delete;                         // as above

   private:
    struct Entry;
    std::shared_ptr<Entry> entry_;
  };

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_CANCELLATION_H_
