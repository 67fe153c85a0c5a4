// Stops calls from anywhere.
#ifndef LATVOX_LATVOX_CANCELLATION_H_
#define LATVOX_LATVOX_CANCELLATION_H_

#include <functional>
#include <memory>

#include "latvox/export.h"

namespace latvox::client {

// A handle of one cancellation; copies share it. A cancellation is final, and may come before, during or after the call
// that has it. Threads: any thread, and the call's own callbacks, may call every method. Signal handlers may not.
class LATVOX_EXPORT Cancellation {
 public:
  Cancellation();  // a new one, not cancelled

  // Stops every call that has it. Returns before they have ended.
  void Cancel() const;

  // Returns whether Cancel was called.
  bool cancelled() const;

  // Runs `action` on Cancel while it lives; at once if Cancel has been called already. Its destructor waits for a
  // running action. The action must not use this Cancellation.
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
