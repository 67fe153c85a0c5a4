// oneTBB's parallel algorithms on plain threads, for ThreadSanitizer only: the preset tsan puts this folder before
// /usr/include. Debian's libtbb is not instrumented. ThreadSanitizer would not see how it orders tasks, and would
// report every parallel loop. Only the parts that core uses are here. The functions given to an algorithm run on other
// threads, in no order except the one that the algorithm promises.
#ifndef LATVOX_TESTS_TSAN_ONEAPI_TBB_PARALLEL_FOR_H_
#define LATVOX_TESTS_TSAN_ONEAPI_TBB_PARALLEL_FOR_H_

#include <oneapi/tbb/blocked_range.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace tbb {

inline constexpr int kSanitizedThreads = 2;

// Runs work(thread) on every thread.
template <class Work>
void RunOnThreads(const Work& work) {
  std::vector<std::thread> threads;
  threads.reserve(kSanitizedThreads);
  for (int n = 0; n < kSanitizedThreads; ++n) threads.emplace_back([&work, n] { work(n); });
  for (std::thread& thread : threads) thread.join();
}

// Runs body(thread, part) for parts of the range. The counter is relaxed, because parts are not ordered among
// themselves.
template <class T, class Body>
void ForEachPart(const blocked_range<T>& range, const Body& body) {
  if (range.empty()) return;
  const size_t grain = range.grainsize(), parts = (range.size() + grain - 1) / grain;
  std::atomic<size_t> next = 0;
  RunOnThreads([&](int thread) {
    for (size_t n; (n = next.fetch_add(1, std::memory_order_relaxed)) < parts;) {
      const T begin = range.begin() + static_cast<T>(n * grain);
      const T end = range.begin() + static_cast<T>(std::min(range.size(), (n + 1) * grain));
      body(thread, blocked_range<T>(begin, end, grain));
    }
  });
}

template <class T, class Body>
void parallel_for(const blocked_range<T>& range, const Body& body) {
  ForEachPart(range, [&body](int, const blocked_range<T>& part) { body(part); });
}

// Parts are always as small as the grain.
struct simple_partitioner {};

template <class T, class Body>
void parallel_for(const blocked_range<T>& range, const Body& body, const simple_partitioner&) {
  parallel_for(range, body);
}

}  // namespace tbb

#endif  // LATVOX_TESTS_TSAN_ONEAPI_TBB_PARALLEL_FOR_H_
