// What was allocated for one block of tiles serves the next.
#ifndef LATVOX_CORE_VOXELIZER_SCAN_POOL_H_
#define LATVOX_CORE_VOXELIZER_SCAN_POOL_H_

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace latvox {

// As many scans as there are threads at work. Threads: any.
template <class Scan>
class ScanPool {
 public:
  std::unique_ptr<Scan> Take() {
    const std::lock_guard lock(mutex_);
    if (idle_.empty()) return std::make_unique<Scan>();
    std::unique_ptr<Scan> scan = std::move(idle_.back());
    idle_.pop_back();
    return scan;
  }
  void Give(std::unique_ptr<Scan> scan) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(scan));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Scan>> idle_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_VOXELIZER_SCAN_POOL_H_
