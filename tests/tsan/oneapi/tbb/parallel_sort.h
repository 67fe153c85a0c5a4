// See parallel_for.h.
#ifndef LATVOX_TESTS_TSAN_ONEAPI_TBB_PARALLEL_SORT_H_
#define LATVOX_TESTS_TSAN_ONEAPI_TBB_PARALLEL_SORT_H_

#include <algorithm>

namespace tbb {

template <class Iterator, class... Compare>
void parallel_sort(Iterator begin, Iterator end, const Compare&... compare) {
  std::sort(begin, end, compare...);
}

}  // namespace tbb

#endif  // LATVOX_TESTS_TSAN_ONEAPI_TBB_PARALLEL_SORT_H_
