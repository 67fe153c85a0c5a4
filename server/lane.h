// Where tasks compute. Small work must not wait for large work: each has a lane, an arena with as many threads as there
// are cores, and the operating system divides the cores between the two.
#ifndef LATVOX_SERVER_LANE_H_
#define LATVOX_SERVER_LANE_H_

#include <oneapi/tbb/task_arena.h>

#include <atomic>
#include <utility>

namespace latvox {

// Thread-safe.
class Lane {
 public:
  explicit Lane(int threads) : threads_(threads), arena_(threads, 0) {}

  int threads() const { return threads_; }

  // Runs task() on a thread of the arena, after what was enqueued before.
  template <class F>
  void Enqueue(F task) {
    ++waiting_;
    arena_.enqueue([this, task = std::move(task)] {
      --waiting_;
      task();
    });
  }

  // Whether tasks wait for those that run: long ones should make way.
  bool contended() const { return waiting_ > 0; }

 private:
  const int threads_;
  oneapi::tbb::task_arena arena_;
  std::atomic<int> waiting_ = 0;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_LANE_H_
