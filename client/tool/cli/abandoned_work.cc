#include "client/tool/cli/abandoned_work.h"

#include <atomic>
#include <thread>

#include "absl/synchronization/mutex.h"
#include "absl/time/clock.h"

namespace latvox::client {
namespace {

std::atomic<bool> g_any_abandoned = false;

}  // namespace

absl::Status CheckTime(const CallOptions& call) {
  if (call.cancellation.cancelled()) return absl::CancelledError("cancelled");
  if (call.deadline && absl::Now() >= *call.deadline) return absl::DeadlineExceededError("the --timeout passed");
  return absl::OkStatus();
}

bool AwaitWork(std::function<void()> work, const CallOptions& call) {
  if (!CheckTime(call).ok()) return false;
  struct Shared {
    absl::Mutex mutex;
    bool done = false, cancelled = false;  // guarded by mutex
    bool IsOver() const { return done || cancelled; }
  };
  const auto shared = std::make_shared<Shared>();
  const Cancellation::Subscription on_cancel(call.cancellation, [shared] {
    const absl::MutexLock lock(&shared->mutex);
    shared->cancelled = true;
  });
  std::thread thread([shared, work = std::move(work)] {
    work();
    const absl::MutexLock lock(&shared->mutex);
    shared->done = true;
  });
  shared->mutex.LockWhenWithDeadline(absl::Condition(shared.get(), &Shared::IsOver),
                                     call.deadline.value_or(absl::InfiniteFuture()));
  const bool done = shared->done;
  shared->mutex.Unlock();
  if (done) {
    // The thread may still run destructors of libraries' thread-local objects. They must not run beside those of the
    // process.
    thread.join();
  } else {
    g_any_abandoned = true;
    thread.detach();
  }
  return done;
}

bool AnyAbandoned() { return g_any_abandoned; }

}  // namespace latvox::client
