// The limits that control groups set for this process: those of containers, batch systems and services.
#ifndef LATVOX_SERVER_BASE_CONTROL_GROUP_H_
#define LATVOX_SERVER_BASE_CONTROL_GROUP_H_

#include <cstdint>
#include <string>

namespace latvox {

struct ControlGroupLimits {
  uint64_t memory_bytes = UINT64_MAX;  // UINT64_MAX: no limit
  int cores = 0;                       // CPU time of so many cores, rounded up; 0: no limit
};

// Returns the tightest limits of all groups that this process is in, of both versions, and of the groups around them,
// as far as this process can see them.
//   root  the folder that has /proc and /sys, without the slash at its end
ControlGroupLimits LimitsOfControlGroups(const std::string& root = "");

}  // namespace latvox

#endif  // LATVOX_SERVER_BASE_CONTROL_GROUP_H_
