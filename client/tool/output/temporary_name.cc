#include "client/tool/output/temporary_name.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <system_error>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/internal/liveness.h"

namespace latvox::client {
namespace {

constexpr char kPartPrefix[] = ".latvox-", kPartSuffix[] = ".part";

std::string TaggedPart() { return absl::StrCat("-", KernelTag(), "-"); }

// Returns whether the file is gone.
bool RemoveIfAbandoned(const std::string& path) {
  const int fd = open(path.c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) return errno == ENOENT;
  struct stat status = {};
  const bool removed = fstat(fd, &status) == 0 && S_ISREG(status.st_mode) && !KernelTag().empty() &&
                       LockFile(fd, path) == Lock::kHeld && unlink(path.c_str()) == 0;
  close(fd);
  return removed;
}

}  // namespace

std::string TakeTemporaryName(const std::filesystem::path& target,
                              const std::function<bool(const std::string&)>& make) {
  const auto hash = static_cast<uint64_t>(std::hash<std::string>()(target.filename().string()));
  const std::string begin = absl::StrCat(kPartPrefix, absl::Hex(hash, absl::kZeroPad16), TaggedPart());
  for (int number = 0;;) {
    std::string path = (target.parent_path() / absl::StrCat(begin, number, kPartSuffix)).string();
    if (make(path)) return path;
    if (errno != EEXIST) return "";
    if (!RemoveIfAbandoned(path)) ++number;
  }
}

void RemoveAbandonedFiles(const std::string& directory) {
  if (KernelTag().empty()) return;
  std::vector<std::string> paths;
  std::error_code error;
  const std::string tag = TaggedPart();
  for (std::filesystem::directory_iterator entry(directory.empty() ? "." : directory, error), end;
       !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (absl::StartsWith(name, kPartPrefix) && absl::EndsWith(name, kPartSuffix) && absl::StrContains(name, tag)) {
      paths.push_back(entry->path().string());
    }
  }
  for (const std::string& path : paths) RemoveIfAbandoned(path);
}

}  // namespace latvox::client
