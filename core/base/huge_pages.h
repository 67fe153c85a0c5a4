// Large pages for large arrays, which spare most of their page faults.
#ifndef LATVOX_CORE_BASE_HUGE_PAGES_H_
#define LATVOX_CORE_BASE_HUGE_PAGES_H_

#include <cstddef>

namespace latvox {

inline constexpr size_t kHugePage = size_t{1} << 21;
inline constexpr size_t WholePages(size_t bytes) { return (bytes + kHugePage - 1) & ~(kHugePage - 1); }

// Whole large pages for an array, or such pages as the system has, which makes no difference but in time; aligned to
// kHugePage, indeterminate. The C library's heap is left out: asked for memory aligned so, it seldom uses again what
// was freed, and grows. Throws std::bad_alloc. Threads: any, here and below.
//   bytes   more than 0, less than 2^63
void* AllocatePages(size_t bytes);

// What AllocatePages(bytes) returned.
void FreePages(void* at, size_t bytes);

// Lets FreePages keep so many bytes in all, of kKeptArrays arrays at most, for others of the same sizes. Default:
// kKeptByDefault (core/base/kept_memory.h).
inline constexpr size_t kKeptArrays = 16;
void KeepPages(size_t bytes);

// Asks the system for large pages within an array that is still to be written to.
void AdviseHugePages(const void* data, size_t bytes);

}  // namespace latvox

#endif  // LATVOX_CORE_BASE_HUGE_PAGES_H_
