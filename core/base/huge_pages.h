// Large pages for large arrays. They save most page faults.
#ifndef LATVOX_CORE_BASE_HUGE_PAGES_H_
#define LATVOX_CORE_BASE_HUGE_PAGES_H_

#include <cstddef>

namespace latvox {

inline constexpr size_t kHugePage = size_t{1} << 21;
inline constexpr size_t WholePages(size_t bytes) { return (bytes + kHugePage - 1) & ~(kHugePage - 1); }

// Returns whole large pages for an array, or pages of another size where the system has no others; only the speed
// differs. They are aligned to kHugePage, with indeterminate content. It does not use the C library's heap: for memory
// with this alignment, the heap seldom reuses freed memory, and grows. Throws std::bad_alloc. Threads: any, here and
// below.
//   bytes   more than 0, less than 2^63
void* AllocatePages(size_t bytes);

// Frees the result of AllocatePages(bytes).
void FreePages(void* at, size_t bytes);

// Lets FreePages keep so many bytes in all, of kKeptArrays arrays at most, for others of the same sizes. Default:
// kKeptByDefault (core/base/kept_memory.h).
inline constexpr size_t kKeptArrays = 16;
void KeepPages(size_t bytes);

// Asks the system for large pages within an array that has not been written to yet.
void AdviseHugePages(const void* data, size_t bytes);

}  // namespace latvox

#endif  // LATVOX_CORE_BASE_HUGE_PAGES_H_
