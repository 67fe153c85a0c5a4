// Measures the memory that a piece of work needs.
#ifndef LATVOX_TESTS_BENCH_PEAK_MEMORY_H_
#define LATVOX_TESTS_BENCH_PEAK_MEMORY_H_

#include <cstdint>
#include <optional>

namespace latvox {

// The peak of the process's resident memory since construction. The constructor first returns freed memory to the
// system, so that it does not count. If the system cannot forget an earlier peak (Linux can), that peak counts as well.
class PeakMemory {
 public:
  PeakMemory();

  uint64_t Bytes() const;
  // Returns the peak beyond the memory held at construction; nullopt if an earlier peak may have hidden it.
  std::optional<uint64_t> BytesBeyondStart() const;

 private:
  bool forgotten_;
  uint64_t start_;
};

}  // namespace latvox

#endif  // LATVOX_TESTS_BENCH_PEAK_MEMORY_H_
