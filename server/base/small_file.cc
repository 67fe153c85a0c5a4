#include "server/base/small_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"

namespace latvox {
namespace {

constexpr size_t kMostBytes = size_t{1} << 20;

absl::Status CannotRead(const std::string& path, absl::string_view why) {
  return absl::InvalidArgumentError(absl::StrCat("cannot read ", path, ": ", why));
}

}  // namespace

absl::StatusOr<SmallFile> ReadSmallFile(const std::string& path) {
  // Without O_NONBLOCK, a pipe without a writer would block here.
  const int fd = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) return CannotRead(path, std::strerror(errno));
  const absl::Cleanup closer = [fd] { close(fd); };
  struct stat facts {};
  if (fstat(fd, &facts) != 0) return CannotRead(path, std::strerror(errno));
  if (!S_ISREG(facts.st_mode)) return CannotRead(path, "it is no regular file");
  SmallFile file{.text = std::string(kMostBytes + 1, '\0'), .readable_by_all = (facts.st_mode & S_IROTH) != 0};
  size_t size = 0;
  for (ssize_t got = 1; got > 0 && size < file.text.size(); size += static_cast<size_t>(got)) {
    got = read(fd, file.text.data() + size, file.text.size() - size);
    if (got < 0) return CannotRead(path, std::strerror(errno));
  }
  if (size > kMostBytes) return CannotRead(path, absl::StrCat("it has more than ", kMostBytes, " bytes"));
  file.text.resize(size);
  return file;
}

}  // namespace latvox
