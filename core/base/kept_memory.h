// Limits of the memory that ended jobs leave to later ones.
#ifndef LATVOX_CORE_BASE_KEPT_MEMORY_H_
#define LATVOX_CORE_BASE_KEPT_MEMORY_H_

#include <malloc.h>

#include <atomic>
#include <cstddef>

#include "core/base/huge_pages.h"

namespace latvox {

// Ended jobs leave memory to later ones: scans (core/block/scan_pool.h) and arrays of large pages (FreePages). Without
// it, a small job has 700 page faults, which take up to a quarter of its time. A process keeps so many bytes of each
// kind, unless KeepJobMemory says otherwise.
inline constexpr size_t kKeptByDefault = size_t{16} << 20;

// The limit of scans. Threads: any may read and write it.
inline std::atomic<size_t> kept_scan_bytes = kKeptByDefault;

// Sets both limits; 0 keeps nothing. Arrays beyond the new limit go back to the system at once, scans beyond it when a
// job takes them. Threads: any.
inline void KeepJobMemory(size_t bytes) {
  KeepPages(bytes);
  kept_scan_bytes = bytes;
}

// For the main functions of programs in which only jobs use the heap. Core itself leaves the host's heap as it is. The
// C library's heap keeps so many freed bytes, and more where several threads free memory. By default it returns them to
// the system, and a job must fetch and clear them again, page by page.
inline void KeepHeap(int bytes) {
  mallopt(M_MMAP_THRESHOLD, bytes / 2);
  mallopt(M_TRIM_THRESHOLD, bytes);
}

// The recommended size of the heap for a program with jobs: no more than the C library would keep by default after a
// job with arrays of 16 MiB. An idle program has it in addition to the budgets of jobs at work.
inline constexpr int kHeapOfJobs = 32 << 20;

}  // namespace latvox

#endif  // LATVOX_CORE_BASE_KEPT_MEMORY_H_
