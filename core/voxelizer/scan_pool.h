// What was allocated for one block of tiles serves the next.
#ifndef LATVOX_CORE_VOXELIZER_SCAN_POOL_H_
#define LATVOX_CORE_VOXELIZER_SCAN_POOL_H_

#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace latvox {

// Up to as many scans as the arena has threads, or as are at work at a time. A thread gets the scan that it had before,
// which its core's cache may still hold. Threads: any.
template <class Scan>
class ScanPool {
 public:
  std::unique_ptr<Scan> Take() {
    const int thread = oneapi::tbb::this_task_arena::current_thread_index();
    const std::lock_guard lock(mutex_);
    auto mine = std::find_if(idle_.begin(), idle_.end(), [&](const Idle& idle) { return idle.thread == thread; });
    if (mine == idle_.end()) {
      if (idle_.empty() || made_ < oneapi::tbb::this_task_arena::max_concurrency()) {
        auto scan = std::make_unique<Scan>();
        ++made_;
        return scan;
      }
      mine = idle_.begin();
    }
    std::unique_ptr<Scan> scan = std::move(mine->scan);
    idle_.erase(mine);
    return scan;
  }
  void Give(std::unique_ptr<Scan> scan) {
    const int thread = oneapi::tbb::this_task_arena::current_thread_index();
    const std::lock_guard lock(mutex_);
    idle_.push_back({thread, std::move(scan)});
  }

 private:
  struct Idle {
    int thread;  // that had it
    std::unique_ptr<Scan> scan;
  };

  std::mutex mutex_;
  std::vector<Idle> idle_;
  int made_ = 0;
};

}  // namespace latvox

#endif  // LATVOX_CORE_VOXELIZER_SCAN_POOL_H_
