// See parallel_for.h.
#ifndef LATVOX_TESTS_TSAN_ONEAPI_TBB_PARALLEL_REDUCE_H_
#define LATVOX_TESTS_TSAN_ONEAPI_TBB_PARALLEL_REDUCE_H_

#include <oneapi/tbb/parallel_for.h>

#include <utility>

namespace tbb {

template <class T, class Value, class Body, class Join>
Value parallel_reduce(const blocked_range<T>& range, const Value& identity, const Body& body, const Join& join) {
  std::vector<Value> values(kSanitizedThreads, identity);
  ForEachPart(
      range, [&](int thread, const blocked_range<T>& part) { values[thread] = body(part, std::move(values[thread])); });
  Value all = identity;
  for (Value& value : values) all = join(std::move(all), std::move(value));
  return all;
}

// The parts are already in this order.
template <class Range, class Value, class Body, class Join>
Value parallel_deterministic_reduce(const Range& range, Value identity, const Body& body, const Join& join) {
  return parallel_reduce(range, std::move(identity), body, join);
}

}  // namespace tbb

#endif  // LATVOX_TESTS_TSAN_ONEAPI_TBB_PARALLEL_REDUCE_H_
