// Large pages for large arrays, which spare most of their page faults.
#ifndef LATVOX_CORE_BASE_HUGE_PAGES_H_
#define LATVOX_CORE_BASE_HUGE_PAGES_H_

#include <sys/mman.h>

#include <cstddef>
#include <cstdint>
#include <new>

namespace latvox {

inline constexpr size_t kHugePage = size_t{1} << 21;

// Whole large pages, `bytes` rounded up, or such pages as the system has: which makes no difference but in time. From
// the system, and at once back to it: heaps, asked for memory aligned so, seldom find what was freed before, and grow.
// Throws std::bad_alloc.
inline void* AllocatePages(size_t bytes) {
  const size_t size = (bytes + kHugePage - 1) & ~(kHugePage - 1);
  // There is one aligned place in as much and a page more.
  void* const all = mmap(nullptr, size + kHugePage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (all == MAP_FAILED) throw std::bad_alloc();
  const size_t before = -reinterpret_cast<uintptr_t>(all) & (kHugePage - 1);
  auto* const at = static_cast<char*>(all) + before;
  if (before != 0) munmap(all, before);
  munmap(at + size, kHugePage - before);
  madvise(at, size, MADV_HUGEPAGE);
  return at;
}
inline void FreePages(void* at, size_t bytes) { munmap(at, (bytes + kHugePage - 1) & ~(kHugePage - 1)); }

// Asks the system for large pages within an array that is still to be written to.
inline void AdviseHugePages(const void* data, size_t bytes) {
  const auto begin = (reinterpret_cast<uintptr_t>(data) + kHugePage - 1) & ~(kHugePage - 1);
  const auto end = (reinterpret_cast<uintptr_t>(data) + bytes) & ~(kHugePage - 1);
  if (begin < end) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
}

}  // namespace latvox

#endif  // LATVOX_CORE_BASE_HUGE_PAGES_H_
