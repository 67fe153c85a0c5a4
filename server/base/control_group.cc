#include "server/base/control_group.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <vector>

#include "absl/algorithm/container.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"

namespace latvox {
namespace {

using Path = std::filesystem::path;

// Returns a number of a file that holds several, or UINT64_MAX if there is none. "max" and version 1's -1 are not
// numbers.
uint64_t NumberIn(const Path& path, int position = 0) {
  std::ifstream file(path);
  std::string word;
  for (int n = 0; n <= position; ++n) file >> word;
  uint64_t number = 0;
  return file && absl::SimpleAtoi(word, &number) ? number : UINT64_MAX;
}

void LimitCores(uint64_t quota, uint64_t period, ControlGroupLimits& limits) {
  if (quota == UINT64_MAX || period == UINT64_MAX || period == 0) return;
  const int cores = static_cast<int>(std::clamp<uint64_t>((quota + period - 1) / period, 1, 1 << 20));
  limits.cores = limits.cores == 0 ? cores : std::min(limits.cores, cores);
}

// Calls `read` for a group and all groups around it. In a container, the path is often that of the machine, although
// only the container's own group is mounted, in place of the outermost one.
void ForEachAround(const Path& mounted, absl::string_view group, const std::function<void(const Path&)>& read) {
  Path path = mounted;
  read(path);
  for (const absl::string_view name : absl::StrSplit(group, '/', absl::SkipEmpty())) {
    path /= std::string(name);
    read(path);
  }
}

}  // namespace

ControlGroupLimits LimitsOfControlGroups(const std::string& root) {
  const Path mounted = absl::StrCat(root, "/sys/fs/cgroup");
  ControlGroupLimits limits;
  const auto limit_memory = [&limits](uint64_t bytes) { limits.memory_bytes = std::min(limits.memory_bytes, bytes); };
  std::ifstream groups(absl::StrCat(root, "/proc/self/cgroup"));
  for (std::string line; std::getline(groups, line);) {
    const std::vector<std::string> parts = absl::StrSplit(line, absl::MaxSplits(':', 2));
    if (parts.size() != 3) continue;
    const std::vector<std::string> controllers = absl::StrSplit(parts[1], ',');
    if (parts[1].empty()) {  // version 2
      ForEachAround(mounted, parts[2], [&](const Path& group) {
        limit_memory(NumberIn(group / "memory.max"));
        LimitCores(NumberIn(group / "cpu.max", 0), NumberIn(group / "cpu.max", 1), limits);
      });
    }
    if (absl::c_linear_search(controllers, "memory")) {
      ForEachAround(mounted / "memory", parts[2],
                    [&](const Path& group) { limit_memory(NumberIn(group / "memory.limit_in_bytes")); });
    }
    if (absl::c_linear_search(controllers, "cpu")) {
      ForEachAround(mounted / "cpu", parts[2], [&](const Path& group) {
        LimitCores(NumberIn(group / "cpu.cfs_quota_us"), NumberIn(group / "cpu.cfs_period_us"), limits);
      });
    }
  }
  return limits;
}

}  // namespace latvox
