#include "core/base/huge_pages.h"

#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <mutex>
#include <new>
#include <utility>

namespace latvox {
namespace {

// What was freed last.
class KeptPages {
 public:
  void Limit(size_t bytes) {
    const std::lock_guard lock(mutex_);
    limit_ = bytes;
    DropWhatExceeds(limit_);
  }
  // Null if there is none of that size.
  void* Take(size_t size) {
    const std::lock_guard lock(mutex_);
    const auto found = std::find_if(arrays_.begin(), arrays_.end(), [&](const Array& a) { return a.size == size; });
    if (found == arrays_.end()) return nullptr;
    bytes_ -= size;
    return std::exchange(*found, {}).at;
  }
  void Give(void* at, size_t size) {
    const std::lock_guard lock(mutex_);
    if (size > limit_) {
      munmap(at, size);
      return;
    }
    DropWhatExceeds(limit_ - size);
    Drop(arrays_.back());
    std::move_backward(arrays_.begin(), arrays_.end() - 1, arrays_.end());
    arrays_.front() = {at, size};
    bytes_ += size;
  }

 private:
  struct Array {
    void* at = nullptr;
    size_t size = 0;
  };
  void Drop(Array& array) {
    if (array.at != nullptr) munmap(array.at, array.size);
    bytes_ -= std::exchange(array, {}).size;
  }
  // The oldest first.
  void DropWhatExceeds(size_t bytes) {
    for (auto array = arrays_.rbegin(); array != arrays_.rend() && bytes_ > bytes; ++array) Drop(*array);
  }

  std::mutex mutex_;
  std::array<Array, 16> arrays_;  // the newest first
  size_t bytes_ = 0, limit_ = 0;
};

KeptPages& Kept() {
  static auto* const kept = new KeptPages;  // which arrays of other static objects may outlive
  return *kept;
}

}  // namespace

void* AllocatePages(size_t bytes) {
  const size_t size = WholePages(bytes);
  if (void* const kept = Kept().Take(size)) return kept;
  // There is one aligned place in as much and a page more.
  void* const all = mmap(nullptr, size + kHugePage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (all == MAP_FAILED) throw std::bad_alloc();
  const size_t before = -reinterpret_cast<uintptr_t>(all) & (kHugePage - 1);
  auto* const at = static_cast<char*>(all) + before;
  if (before != 0) munmap(all, before);
  munmap(at + size, kHugePage - before);
  AdviseHugePages(at, size);
  return at;
}

void FreePages(void* at, size_t bytes) { Kept().Give(at, WholePages(bytes)); }

void KeepPages(size_t bytes) { Kept().Limit(bytes); }

void AdviseHugePages(const void* data, size_t bytes) {
  const uintptr_t begin = WholePages(reinterpret_cast<uintptr_t>(data));
  const auto end = (reinterpret_cast<uintptr_t>(data) + bytes) & ~(kHugePage - 1);
  if (begin < end) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
}

}  // namespace latvox
