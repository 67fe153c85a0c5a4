// Reuses the memory of one block of tiles for the next, in the same job or a later one.
#ifndef LATVOX_CORE_BLOCK_SCAN_POOL_H_
#define LATVOX_CORE_BLOCK_SCAN_POOL_H_

#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "core/base/kept_memory.h"

namespace latvox {

// Scans that jobs have left, kept_scan_bytes in all, and at most kMost. Threads: any.
template <class Scan>
class LeftScans {
 public:
  static LeftScans& Get() {
    static auto* const left = new LeftScans;  // never destroyed, because jobs may end after other static objects
    return *left;
  }

  // Null if there is none.
  std::unique_ptr<Scan> Reserve() {
    const std::lock_guard lock(mutex_);
    if (size_ == 0) return nullptr;
    std::unique_ptr<Scan> scan = std::move(scans_[--size_]);
    bytes_ -= scan->Bytes();
    return scan;
  }
  void Add(std::unique_ptr<Scan> scan) {  // does not throw
    const size_t bytes = scan->Bytes();
    const std::lock_guard lock(mutex_);
    if (size_ == kMost || bytes_ + bytes > kept_scan_bytes) return;
    bytes_ += bytes;
    scans_[size_++] = std::move(scan);
  }

 private:
  static constexpr size_t kMost = 64;

  std::mutex mutex_;
  std::array<std::unique_ptr<Scan>, kMost> scans_;
  size_t size_ = 0, bytes_ = 0;
};

// Holds as many scans as the arena has threads, or as run at a time. A thread gets back its last scan, which its core's
// cache may still hold. Threads: any.
template <class Scan>
class ScanPool {
 public:
  std::unique_ptr<Scan> Reserve() {
    const int thread = oneapi::tbb::this_task_arena::current_thread_index();
    const std::lock_guard lock(mutex_);
    auto mine = std::find_if(idle_.begin(), idle_.end(), [&](const Idle& idle) { return idle.thread == thread; });
    if (mine == idle_.end()) {
      if (idle_.empty() || made_ < oneapi::tbb::this_task_arena::max_concurrency()) {
        ++made_;
        if constexpr (kMayLeave) {
          if (auto scan = LeftScans<Scan>::Get().Reserve()) return scan;
        }
        return std::make_unique<Scan>();
      }
      mine = idle_.begin();
    }
    std::unique_ptr<Scan> scan = std::move(mine->scan);
    idle_.erase(mine);
    return scan;
  }
  void Release(std::unique_ptr<Scan> scan) {
    const int thread = oneapi::tbb::this_task_arena::current_thread_index();
    const std::lock_guard lock(mutex_);
    idle_.push_back({thread, std::move(scan)});
  }
  // Leaves the scans to later jobs. Precondition: all are back, and each has finished its blocks.
  void Leave() {
    for (Idle& idle : idle_) LeftScans<Scan>::Get().Add(std::move(idle.scan));
    idle_.clear();
  }

 private:
  static constexpr bool kMayLeave = requires(const Scan& scan) { scan.Bytes(); };
  struct Idle {
    int thread;  // the one that had it
    std::unique_ptr<Scan> scan;
  };

  std::mutex mutex_;
  std::vector<Idle> idle_;
  int made_ = 0;
};

}  // namespace latvox

#endif  // LATVOX_CORE_BLOCK_SCAN_POOL_H_
