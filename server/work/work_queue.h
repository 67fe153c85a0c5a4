// Queues of tasks. Small work must not wait for large work, so each has a queue with as many threads as there are
// cores. The operating system divides the cores between the two by the priority of their threads.
//
// oneTBB's workers go from arena to arena, and a thread that has lowered its priority cannot raise it again without
// privileges (RLIMIT_NICE). So a queue of lower priority has threads of its own, which stay. On a machine of many
// cores, they take a tenth of a second to start, so all except one start with the first task.
//
// Threads of gRPC enqueue tasks, and may end before the tasks run. In oneTBB 2022.1, which Debian 13 has, a task of a
// task_group then uses memory that has been freed. So a queue has no task_group for them, and counts them itself.
#ifndef LATVOX_SERVER_WORK_WORK_QUEUE_H_
#define LATVOX_SERVER_WORK_WORK_QUEUE_H_

#include <oneapi/tbb/task_arena.h>

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace latvox {

// Thread-safe.
class WorkQueue {
 public:
  // `niceness` is added to the process's own for the queue's threads; 0: oneTBB's workers are the threads.
  WorkQueue(int threads, int niceness);
  ~WorkQueue() noexcept;  // as Wait
  WorkQueue(const WorkQueue&) = delete;
  WorkQueue& operator=(const WorkQueue&) = delete;

  int threads() const { return threads_; }

  // Whether its threads, and the threads that they start, have a lower priority than the process's others.
  bool nice() const { return niceness_.has_value(); }

  // Runs task() on a thread of the queue, after all earlier tasks. Its parallel algorithms use all threads.
  template <class F>
  void Enqueue(F task) {
    if (nice()) std::call_once(started_, [this] { StartOthers(); });
    ++waiting_;
    arena_.enqueue(Task<F>{CountTask(), std::move(task)});
  }

  // Waits for all tasks.
  void Wait();

  // Whether tasks wait for running ones; long tasks should make way.
  bool contended() const { return waiting_ > 0; }

 private:
  class Resident;

  struct Uncount {
    void operator()(WorkQueue* queue) const { queue->UncountTask(); }
  };
  using Counted = std::unique_ptr<WorkQueue, Uncount>;

  // It is counted until `task` has been destroyed, with all that it holds.
  template <class F>
  struct Task {
    void operator()() const noexcept {
      --counted->waiting_;
      task();
    }
    Counted counted;
    F task;
  };

  Counted CountTask();
  void UncountTask();
  void StartOthers();

  const int threads_;
  const std::optional<int> niceness_;  // of its own threads
  oneapi::tbb::task_arena arena_;
  std::atomic<int> waiting_ = 0;
  std::mutex mu_;
  std::condition_variable no_tasks_;
  size_t tasks_ = 0;  // guarded by mu_
  std::once_flag started_;
  std::vector<std::unique_ptr<Resident>> residents_;
};

// Runs act(), which calls gRPC, for a task of `queue`: at once, but from a nice queue on a thread of `ordinary`. A
// thread that calls gRPC may start gRPC's own threads, and holds locks that other calls need.
template <class F>
void DoOrdinarily(const WorkQueue& queue, WorkQueue& ordinary, F act) {
  queue.nice() ? ordinary.Enqueue(std::move(act)) : act();
}

}  // namespace latvox

#endif  // LATVOX_SERVER_WORK_WORK_QUEUE_H_
