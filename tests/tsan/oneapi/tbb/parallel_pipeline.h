// See parallel_for.h. A pipeline of three filters: the first and last are serial and in order, the second is parallel.
#ifndef LATVOX_TESTS_TSAN_ONEAPI_TBB_PARALLEL_PIPELINE_H_
#define LATVOX_TESTS_TSAN_ONEAPI_TBB_PARALLEL_PIPELINE_H_

#include <oneapi/tbb/parallel_for.h>

#include <condition_variable>
#include <mutex>
#include <utility>

namespace tbb {

enum class filter_mode { parallel, serial_in_order, serial_out_of_order };

class flow_control {
 public:
  void stop() { stopped_ = true; }
  bool stopped() const { return stopped_; }

 private:
  bool stopped_ = false;
};

template <class In, class Out, class Body>
struct Filter {
  Body body;
};

template <class In, class Out, class Body>
Filter<In, Out, Body> make_filter(filter_mode, Body body) {
  return {std::move(body)};
}

template <class First, class Second>
struct Filters {
  First first;
  Second second;
};

template <class A, class B, class F, class C, class G>
Filters<Filter<A, B, F>, Filter<B, C, G>> operator&(Filter<A, B, F> first, Filter<B, C, G> second) {
  return {std::move(first), std::move(second)};
}

template <class First, class Second, class B, class C, class F>
Filters<Filters<First, Second>, Filter<B, C, F>> operator&(Filters<First, Second> first, Filter<B, C, F> second) {
  return {std::move(first), std::move(second)};
}

// At most kSanitizedThreads items are in the pipeline. Core asks for as many or more.
template <class Source, class Work, class Sink>
void parallel_pipeline(size_t, const Filters<Filters<Source, Work>, Sink>& filters) {
  std::mutex source, sink;
  std::condition_variable turn;
  flow_control flow;
  size_t entered = 0, left = 0;
  RunOnThreads([&](int) {
    for (;;) {
      std::unique_lock entry(source);
      if (flow.stopped()) return;
      auto item = filters.first.first.body(flow);
      if (flow.stopped()) return;
      const size_t ticket = entered++;
      entry.unlock();
      auto result = filters.first.second.body(std::move(item));
      std::unique_lock exit(sink);
      turn.wait(exit, [&] { return left == ticket; });
      filters.second.body(std::move(result));
      ++left;
      turn.notify_all();
    }
  });
}

}  // namespace tbb

#endif  // LATVOX_TESTS_TSAN_ONEAPI_TBB_PARALLEL_PIPELINE_H_
