// Large pages for large arrays.
#ifndef LATVOX_CORE_BASE_HUGE_PAGES_H_
#define LATVOX_CORE_BASE_HUGE_PAGES_H_

#include <sys/mman.h>

#include <cstddef>
#include <cstdint>

namespace latvox {

inline constexpr size_t kHugePage = size_t{1} << 21;

// Asks the system for large pages within an array that is still to be written to, which spares most of its page faults.
// Whether it complies makes no difference but in time.
inline void AdviseHugePages(const void* data, size_t bytes) {
  const auto begin = (reinterpret_cast<uintptr_t>(data) + kHugePage - 1) & ~(kHugePage - 1);
  const auto end = (reinterpret_cast<uintptr_t>(data) + bytes) & ~(kHugePage - 1);
  if (begin < end) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
}

}  // namespace latvox

#endif  // LATVOX_CORE_BASE_HUGE_PAGES_H_
