#include "tests/bench/peak_memory.h"

#include <malloc.h>

#include <fstream>
#include <limits>
#include <string>

namespace latvox {
namespace {

// Returns a field of /proc/self/status, which is in kB.
uint64_t StatusBytes(const std::string& field) {
  std::ifstream status("/proc/self/status");
  uint64_t kilobytes = 0;
  for (std::string name; status >> name && name != field + ':';) {
    status.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  status >> kilobytes;
  return kilobytes * 1024;
}

// Resets VmHWM to VmRSS.
bool ForgetPeak() {
  std::ofstream refs("/proc/self/clear_refs");
  refs << 5 << std::flush;
  return refs.good();
}

}  // namespace

PeakMemory::PeakMemory() {
  malloc_trim(0);
  forgotten_ = ForgetPeak();
  start_ = StatusBytes("VmRSS");
}

uint64_t PeakMemory::Bytes() const { return StatusBytes("VmHWM"); }

std::optional<uint64_t> PeakMemory::BytesBeyondStart() const {
  const uint64_t peak = Bytes();
  if (!forgotten_ || peak < start_) return std::nullopt;
  return peak - start_;
}

}  // namespace latvox
