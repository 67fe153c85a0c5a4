// Parallel work whose time counts for the meter of the calling thread, on whichever threads it runs.
#ifndef LATVOX_CORE_BASE_METERED_H_
#define LATVOX_CORE_BASE_METERED_H_

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <utility>

#include "core/base/cpu_meter.h"

namespace latvox {

// As TBB's functions with these arguments. The body must not wait for other parallel work, except in isolation: a
// thread that waits may begin work of another job, which would count for both.
template <class Range, class Body>
void MeteredFor(const Range& range, const Body& body) {
  oneapi::tbb::parallel_for(range, [&body, meter = CpuMeter::OfThread()](const Range& part) {
    const CpuMeter::Scope scope(meter);
    body(part);
  });
}

template <class Range, class Value, class Body, class Join>
Value MeteredReduce(const Range& range, const Value& identity, const Body& body, const Join& join) {
  return oneapi::tbb::parallel_deterministic_reduce(
      range, identity,
      [&body, meter = CpuMeter::OfThread()](const Range& part, Value value) {
        const CpuMeter::Scope scope(meter);
        return body(part, std::move(value));
      },
      join);
}

}  // namespace latvox

#endif  // LATVOX_CORE_BASE_METERED_H_
