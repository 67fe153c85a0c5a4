#include "server/base/process_facts.h"

#include <dirent.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <string>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"

namespace latvox {
namespace {

// Returns a field of /proc/self/stat, counted from 1 as in proc(5). The second field, the program's name, may hold any
// character.
double StatField(size_t number) {
  std::string line;
  std::getline(std::ifstream("/proc/self/stat"), line);
  const std::vector<std::string> fields = absl::StrSplit(line.substr(line.rfind(')') + 1), ' ', absl::SkipEmpty());
  double value = 0;
  if (fields.size() <= number - 3 || !absl::SimpleAtod(fields[number - 3], &value)) return 0;
  return value;
}

double BootTimeSeconds() {
  std::ifstream file("/proc/stat");
  for (std::string line; std::getline(file, line);) {
    absl::string_view rest = line;
    double seconds = 0;
    if (absl::ConsumePrefix(&rest, "btime ") && absl::SimpleAtod(rest, &seconds)) return seconds;
  }
  return 0;
}

double Seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) / 1e6;
}

}  // namespace

double PrivateMemoryBytes(pid_t pid) {
  uint64_t size = 0, resident = 0, shared = 0;
  std::ifstream(absl::StrCat("/proc/", pid, "/statm")) >> size >> resident >> shared;
  return static_cast<double>(resident - std::min(resident, shared)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

double ResidentMemoryBytes() { return StatField(24) * static_cast<double>(sysconf(_SC_PAGESIZE)); }

double CpuSeconds() {
  rusage usage{};
  return getrusage(RUSAGE_SELF, &usage) == 0 ? Seconds(usage.ru_utime) + Seconds(usage.ru_stime) : 0;
}

double OpenFiles() {
  DIR* const directory = opendir("/proc/self/fd");
  if (directory == nullptr) return 0;
  double count = -3;  // ".", ".." and the entry of the directory that is being listed
  while (readdir(directory) != nullptr) ++count;
  closedir(directory);
  return count;
}

double MaxOpenFiles() {
  rlimit limit{};
  return getrlimit(RLIMIT_NOFILE, &limit) == 0 ? static_cast<double>(limit.rlim_cur) : 0;
}

double Threads() { return StatField(20); }

double StartTimeSeconds() { return BootTimeSeconds() + StatField(22) / static_cast<double>(sysconf(_SC_CLK_TCK)); }

}  // namespace latvox
