#include "server/work/work_queue.h"

#include <oneapi/tbb/task_group.h>
#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <future>
#include <thread>

#include "server/base/log.h"

namespace latvox {
namespace {

// Lowers the priority of this thread; Linux has a niceness for each. Everyone may raise it. Where a sandbox forbids
// even that, work goes on, less fairly.
void AddToNiceness(int niceness) {
  const auto self = static_cast<id_t>(gettid());
  errno = 0;
  const int before = getpriority(PRIO_PROCESS, self);  // -1 is a valid niceness, too
  if (errno == 0 && setpriority(PRIO_PROCESS, self, before + niceness) == 0) return;
  Log(LogLevel::kWarning, "priority_not_lowered", {{"error", std::strerror(errno)}});
}

// An arena needs a second place: with a single one, a worker would take an enqueued task.
int PlacesFor(int threads) { return std::max(threads, 2); }

}  // namespace

// A thread that waits in the arena for an event that comes only at the end. Like every thread that waits within oneTBB,
// it runs the arena's tasks meanwhile, and sleeps while there are none. The event is that a handle goes, which this
// thread makes: it must not outlive its maker.
class WorkQueue::Resident {
 public:
  Resident(oneapi::tbb::task_arena& arena, int niceness)
      : thread_([this, &arena, niceness] {
          pthread_setname_np(pthread_self(), "latvoxd-bulk");
          AddToNiceness(niceness);
          arena.execute([this] {
            end_.set_value(awaited_.defer([] {}));
            awaited_.wait();
          });
        }) {}
  ~Resident() {
    end_.get_future().get() = {};
    thread_.join();
  }

 private:
  oneapi::tbb::task_group awaited_;
  std::promise<oneapi::tbb::task_handle> end_;
  std::thread thread_;
};

WorkQueue::WorkQueue(int threads, int niceness)
    : threads_(threads), arena_(niceness == 0 ? threads : PlacesFor(threads), niceness == 0 ? 0 : PlacesFor(threads)) {
  if (niceness == 0) return;
  for (int n = 0; n < threads; ++n) residents_.push_back(std::make_unique<Resident>(arena_, niceness));
}

WorkQueue::~WorkQueue() noexcept { Wait(); }

void WorkQueue::Wait() {
  std::unique_lock lock(mu_);
  no_tasks_.wait(lock, [this] { return tasks_ == 0; });
}

WorkQueue::Counted WorkQueue::CountTask() {
  const std::lock_guard lock(mu_);
  ++tasks_;
  return Counted(this);
}

// Notifies under mu_, because the queue may go as soon as the waiting thread has mu_.
void WorkQueue::UncountTask() {
  const std::lock_guard lock(mu_);
  if (--tasks_ == 0) no_tasks_.notify_all();
}

}  // namespace latvox
