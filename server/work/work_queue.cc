#include "server/work/work_queue.h"

#include <oneapi/tbb/task_group.h>
#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <exception>
#include <future>
#include <thread>

#include "server/base/log.h"

namespace latvox {
namespace {

// Returns the niceness of a thread that has `more` than this one; nullopt for 0, which asks for no such threads.
std::optional<int> NicenessBeyondThis(int more) {
  if (more == 0) return std::nullopt;
  errno = 0;
  const int now = getpriority(PRIO_PROCESS, static_cast<id_t>(gettid()));  // -1 is a valid niceness, too
  return (errno == 0 ? now : 0) + more;
}

// Lowers the priority of this thread; Linux has a niceness for each. Everyone may raise it. Where a sandbox forbids
// even that, work goes on, less fairly.
void SetNiceness(int niceness) {
  if (setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), niceness) == 0) return;
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
          SetNiceness(niceness);
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
    : threads_(threads),
      niceness_(NicenessBeyondThis(niceness)),
      arena_(nice() ? PlacesFor(threads) : threads, nice() ? PlacesFor(threads) : 0) {
  if (nice()) residents_.push_back(std::make_unique<Resident>(arena_, *niceness_));
}

// A server that has begun to serve goes on where the system refuses threads: one is enough for all tasks.
void WorkQueue::StartOthers() {
  try {
    while (static_cast<int>(residents_.size()) < threads_) {
      residents_.push_back(std::make_unique<Resident>(arena_, *niceness_));
    }
  } catch (const std::exception& error) {  // no thread, or no memory
    Log(LogLevel::kWarning, "threads_not_started",
        {{"error", error.what()}, {"of", threads_}, {"started", residents_.size()}});
  }
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
