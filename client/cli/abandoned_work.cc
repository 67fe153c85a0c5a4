#include "client/cli/abandoned_work.h"

#include <atomic>
#include <thread>

#include "absl/synchronization/mutex.h"
#include "absl/time/clock.h"

namespace latvox::client {
namespace {

std::atomic<int> g_running = 0;

}  // namespace

absl::Status CheckTime(const CallOptions& call) {
  if (call.cancellation.cancelled()) return absl::CancelledError("cancelled");
  if (call.deadline && absl::Now() >= *call.deadline) return absl::DeadlineExceededError("the --timeout passed");
  return absl::OkStatus();
}

bool AwaitWork(std::function<void()> work, const CallOptions& call) {
  struct Shared {
    absl::Mutex mutex;
    bool done = false, cancelled = false;  // guarded by mutex
    bool IsOver() const { return done || cancelled; }
  };
  const auto shared = std::make_shared<Shared>();
  std::thread([shared, work = std::move(work)] {
    work();
    --g_running;
    const absl::MutexLock lock(&shared->mutex);
    shared->done = true;
  }).detach();
  ++g_running;
  const Cancellation::Subscription on_cancel(call.cancellation, [shared] {
    const absl::MutexLock lock(&shared->mutex);
    shared->cancelled = true;
  });
  const absl::MutexLock lock(&shared->mutex);
  shared->mutex.AwaitWithDeadline(absl::Condition(shared.get(), &Shared::IsOver),
                                  call.deadline.value_or(absl::InfiniteFuture()));
  return shared->done;
}

bool AnyAbandoned() { return g_running > 0; }

}  // namespace latvox::client
