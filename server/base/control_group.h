// What the process's control groups allow it: the limits of containers, of batch systems, of services.
#ifndef LATVOX_SERVER_BASE_CONTROL_GROUP_H_
#define LATVOX_SERVER_BASE_CONTROL_GROUP_H_

#include <cstdint>
#include <string>

namespace latvox {

struct ControlGroupLimits {
  uint64_t memory_bytes = UINT64_MAX;  // UINT64_MAX: none
  int cores = 0;                       // time of so many cores, rounded up; 0: no limit
};

// The tightest limits of the groups of either version that this process is in, and of the groups around these, as far
// as they can be seen.
//   root  where /proc and /sys are, without the slash at its end
ControlGroupLimits LimitsOfControlGroups(const std::string& root = "");

}  // namespace latvox

#endif  // LATVOX_SERVER_BASE_CONTROL_GROUP_H_
