#include "core/base/huge_pages.h"

#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <mutex>
#include <new>

#include "core/base/kept_memory.h"

namespace latvox {
namespace {

struct Array {
  void* at = nullptr;
  size_t size = 0;
};

// The arrays that were freed last, up to a number and a size.
class KeptPages {
 public:
  void Limit(size_t bytes) {
    Dropped dropped;
    const std::lock_guard lock(mutex_);
    limit_ = bytes;
    while (bytes_ > limit_) DropOldest(dropped);
  }
  // Returns the newest array of that size, which caches may still hold; null if there is none.
  void* Reserve(size_t size) {
    const std::lock_guard lock(mutex_);
    for (size_t n = count_; n-- > 0;) {
      if (arrays_[n].size == size) return Remove(n).at;
    }
    return nullptr;
  }
  void Release(const Array& array) {
    Dropped dropped;
    const std::lock_guard lock(mutex_);
    if (array.size > limit_) return dropped.Add(array);
    while (bytes_ + array.size > limit_ || count_ == kKeptArrays) DropOldest(dropped);
    arrays_[count_++] = array;
    bytes_ += array.size;
  }

 private:
  // Unmaps arrays when it is destroyed, after the lock is released, because unmapping takes long enough for others to
  // wait.
  class Dropped {
   public:
    ~Dropped() {
      for (size_t n = 0; n < count_; ++n) munmap(arrays_[n].at, arrays_[n].size);
    }
    void Add(const Array& array) { arrays_[count_++] = array; }

   private:
    std::array<Array, kKeptArrays> arrays_;
    size_t count_ = 0;
  };

  Array Remove(size_t n) {
    const Array array = arrays_[n];
    std::move(arrays_.begin() + n + 1, arrays_.begin() + count_, arrays_.begin() + n);
    --count_;
    bytes_ -= array.size;
    return array;
  }
  void DropOldest(Dropped& dropped) { dropped.Add(Remove(0)); }

  std::mutex mutex_;
  std::array<Array, kKeptArrays> arrays_;  // the first count_ are valid, the oldest first
  size_t count_ = 0, bytes_ = 0, limit_ = kKeptByDefault;
};

KeptPages& Kept() {
  static auto* const kept = new KeptPages;  // never destroyed, because arrays of other static objects may outlive it
  return *kept;
}

}  // namespace

void* AllocatePages(size_t bytes) {
  const size_t size = WholePages(bytes);
  if (void* const kept = Kept().Reserve(size)) return kept;
  // As much and a page more contains one aligned place.
  void* const all = mmap(nullptr, size + kHugePage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (all == MAP_FAILED) throw std::bad_alloc();
  const size_t before = -reinterpret_cast<uintptr_t>(all) & (kHugePage - 1);
  auto* const at = static_cast<char*>(all) + before;
  if (before != 0) munmap(all, before);
  munmap(at + size, kHugePage - before);
  AdviseHugePages(at, size);
  return at;
}

void FreePages(void* at, size_t bytes) { Kept().Release({at, WholePages(bytes)}); }

void KeepPages(size_t bytes) { Kept().Limit(bytes); }

void AdviseHugePages(const void* data, size_t bytes) {
  const auto first = reinterpret_cast<uintptr_t>(data);
  const uintptr_t begin = WholePages(first), end = (first + bytes) & ~(kHugePage - 1);
  auto* const at = static_cast<char*>(const_cast<void*>(data)) + (begin - first);
  if (begin < end) madvise(at, end - begin, MADV_HUGEPAGE);
}

}  // namespace latvox
