// Memory that is given back, kept for what comes next.
#ifndef LATVOX_CORE_BASE_KEPT_MEMORY_H_
#define LATVOX_CORE_BASE_KEPT_MEMORY_H_

#include <malloc.h>

#include <atomic>
#include <cstddef>

#include "core/base/huge_pages.h"

namespace latvox {

// What a job gives back serves the next: without, a small job has 700 page faults, up to a quarter of its time. The
// heap's part is no more than the C library by itself would keep after a job with arrays of 16 MiB; scans and arrays of
// large pages are as much again. Idle programs have it all, beside what budgets of memory reserve for jobs at work.
inline constexpr int kMemoryKeptByJobs = 32 << 20;

// Up to how many bytes of scans ended jobs leave to later ones: core/block/scan_pool.h.
inline std::atomic<size_t> kept_scan_bytes = 0;

// Lets the C library keep so many bytes of this process's freed memory, more where several threads free it, and half as
// many each of scans and of arrays of large pages; by itself it returns it to the system, from which it would
// have to be fetched, and cleared, page by page. For main functions.
inline void KeepFreedMemory(int bytes) {
  mallopt(M_MMAP_THRESHOLD, bytes / 2);
  mallopt(M_TRIM_THRESHOLD, bytes);
  KeepPages(static_cast<size_t>(bytes) / 2);
  kept_scan_bytes = static_cast<size_t>(bytes) / 2;
}

}  // namespace latvox

#endif  // LATVOX_CORE_BASE_KEPT_MEMORY_H_
