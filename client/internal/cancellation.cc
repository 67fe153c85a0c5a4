#include "latvox/cancellation.h"

#include <atomic>
#include <list>
#include <mutex>
#include <utility>

namespace latvox::client {

struct Cancellation::State {
  std::atomic<bool> cancelled = false;
  std::mutex mutex;
  std::list<std::function<void()>> actions;  // guarded by mutex
};

// The list's iterators stay valid while other entries come and go.
struct Cancellation::Subscription::Entry {
  std::shared_ptr<State> state;
  std::list<std::function<void()>>::iterator position;
};

Cancellation::Cancellation() : state_(std::make_shared<State>()) {}

void Cancellation::Cancel() const {
  // Actions run under the lock, so that a Subscription's destructor cannot overtake one.
  std::lock_guard lock(state_->mutex);
  if (state_->cancelled.exchange(true)) return;
  for (const auto& action : state_->actions) action();
}

bool Cancellation::cancelled() const { return state_->cancelled; }

Cancellation::Subscription::Subscription(const Cancellation& cancellation, std::function<void()> action)
    : entry_(std::make_shared<Entry>()) {
  entry_->state = cancellation.state_;
  std::lock_guard lock(entry_->state->mutex);
  if (entry_->state->cancelled) action();
  entry_->position = entry_->state->actions.insert(entry_->state->actions.end(), std::move(action));
}

Cancellation::Subscription::~Subscription() {
  std::lock_guard lock(entry_->state->mutex);
  entry_->state->actions.erase(entry_->position);
}

}  // namespace latvox::client
