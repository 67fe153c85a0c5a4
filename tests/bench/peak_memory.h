// How much memory a piece of work takes.
#ifndef LATVOX_TESTS_BENCH_PEAK_MEMORY_H_
#define LATVOX_TESTS_BENCH_PEAK_MEMORY_H_

#include <cstdint>
#include <optional>

namespace latvox {

// The peak of the process's resident memory since construction. What was freed before is given back to the system
// first, so that it does not count. Where the system cannot forget an earlier peak (Linux can), that one counts, too.
class PeakMemory {
 public:
  PeakMemory();

  uint64_t Bytes() const;
  // What was taken beyond what the process held at construction; nullopt where an earlier peak may have hidden it.
  std::optional<uint64_t> BytesBeyondStart() const;

 private:
  bool forgotten_;
  uint64_t start_;
};

}  // namespace latvox

#endif  // LATVOX_TESTS_BENCH_PEAK_MEMORY_H_
