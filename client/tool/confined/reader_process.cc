#include "client/tool/confined/reader_process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/tool/vdb/program_path.h"
#include "client/tool/vdb/vdb.h"
#include "deploy/process/child.h"

namespace latvox::client {
namespace {

constexpr uint64_t kLeastMemory = uint64_t{4} << 30, kMemoryPerByte = 64;
constexpr uint64_t kLeastSeconds = 30, kBytesPerSecond = uint64_t{1} << 20;
constexpr int kWaitMs = 50;  // between two looks at the cancellation

// An open file, closed at the end.
struct OpenFile {
  explicit OpenFile(int number) : fd(number) {}
  ~OpenFile() {
    if (fd >= 0) close(fd);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  int fd;
};

// Returns errno. Both files have numbers above kReaderChannel, as ChildSetting needs.
int Spawn(std::vector<std::string> words, int file, int channel, pid_t& pid) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  // The loader must find the same libraries. Nothing else of the environment, such as a token, goes to the reader.
  constexpr char kLibraries[] = "LD_LIBRARY_PATH";
  const char* const folders = std::getenv(kLibraries);
  std::string libraries = absl::StrCat(kLibraries, "=", folders != nullptr ? folders : "");
  char* environment[] = {folders != nullptr ? libraries.data() : nullptr, nullptr};
  const ChildSetting setting({file, channel});
  return posix_spawn(&pid, ProgramPath().c_str(), &setting.files, &setting.attributes, arguments.data(), environment);
}

absl::Status CannotOpen(const std::string& path, int error) {
  if (error == ENOENT) return absl::NotFoundError(absl::StrCat(path, ": no such file"));
  return absl::InvalidArgumentError(absl::StrCat(path, ": cannot be opened (", std::strerror(error), ")"));
}

absl::Status CannotStart(const std::string& path, int error) {
  return absl::ResourceExhaustedError(
      absl::StrCat(path, ": the process that reads it cannot start (", std::strerror(error), ")"));
}

int Above(int fd) { return fcntl(fd, F_DUPFD_CLOEXEC, kReaderChannel + 1); }

}  // namespace

ReaderLimits ReaderLimitsFor(uint64_t file_bytes) {
  return {std::max(kLeastMemory, kMemoryPerByte * file_bytes), kLeastSeconds + file_bytes / kBytesPerSecond};
}

absl::StatusOr<std::unique_ptr<ReaderProcess>> ReaderProcess::Start(const std::string& path, const std::string& what,
                                                                    const Cancellation& cancellation) {
  // A pipe without a writer would make open() wait.
  const OpenFile opened(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (opened.fd < 0) return CannotOpen(path, errno);
  struct stat facts {};
  if (fstat(opened.fd, &facts) != 0) return CannotOpen(path, errno);
  if (S_ISDIR(facts.st_mode)) return CannotOpen(path, EISDIR);
  if (!S_ISREG(facts.st_mode)) return absl::InvalidArgumentError(absl::StrCat(path, ": is not a file"));
  const OpenFile file(Above(opened.fd));
  int ends[2];
  if (file.fd < 0 || pipe2(ends, O_CLOEXEC) != 0) return CannotStart(path, errno);
  OpenFile in(ends[0]);
  const OpenFile out(ends[1]), channel(Above(out.fd));
  if (channel.fd < 0) return CannotStart(path, errno);
  const ReaderLimits limits = ReaderLimitsFor(static_cast<uint64_t>(facts.st_size));
  pid_t pid = 0;
  const int error = Spawn({"latvox", kReaderArgument, absl::StrCat(getpid()), absl::StrCat(limits.memory),
                           absl::StrCat(limits.seconds), what, path},
                          file.fd, channel.fd, pid);
  if (error != 0) return CannotStart(path, error);
  std::unique_ptr<ReaderProcess> process(new ReaderProcess(path, limits, pid, in.fd, cancellation));
  in.fd = -1;
  return process;
}

ReaderProcess::~ReaderProcess() {
  if (pid_ > 0) {
    kill(pid_, SIGKILL);
    while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) continue;
  }
  close(channel_);
}

absl::Status ReaderProcess::Receive(void* to, size_t bytes) {
  if (bytes > limits_.memory - received_) return absl::DataLossError("too many bytes");
  received_ += bytes;
  char* at = static_cast<char*>(to);
  while (bytes > 0) {
    if (cancellation_.cancelled()) return absl::CancelledError("cancelled");
    pollfd source{channel_, POLLIN, 0};
    if (poll(&source, 1, kWaitMs) <= 0) continue;
    const ssize_t got = read(channel_, at, bytes);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return absl::DataLossError("the process has ended");
    at += got;
    bytes -= static_cast<size_t>(got);
  }
  return absl::OkStatus();
}

absl::Status ReaderProcess::Blame() {
  // A process that ends closes its end of the pipe.
  pollfd source{channel_, POLLIN, 0};
  const bool alive = poll(&source, 1, 0) == 0 || (source.revents & POLLHUP) == 0;
  if (alive) kill(pid_, SIGKILL);
  siginfo_t info{};
  while (waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED) != 0 && errno == EINTR) continue;
  pid_ = 0;
  return alive ? Damaged(": the process that read it sent nonsense") : BlameEnd(info.si_code, info.si_status);
}

absl::Status ReaderProcess::Damaged(const std::string& why) const {
  return absl::InvalidArgumentError(absl::StrCat(path_, ": is damaged", why));
}

absl::Status ReaderProcess::BlameEnd(int code, int status) const {
  if (code == CLD_EXITED) {
    if (status == kReaderDone) return Damaged(": the process that read it sent too little");
    if (status == kReaderLacksLibrary) {
      const auto vdb = Vdb::Load();  // for the reason
      if (!vdb.ok()) return vdb.status();
      return absl::ResourceExhaustedError(absl::StrCat(path_, ": the process that reads it cannot load OpenVDB"));
    }
    if (status == kReaderOutOfMemory) {
      return Damaged(absl::StrCat(", or needs more than ", limits_.memory, " bytes of memory to read"));
    }
    if (status > kReaderCannotSend && strerrorname_np(status - kReaderCannotSend) != nullptr) {
      return absl::ResourceExhaustedError(absl::StrCat(path_, ": the process that reads it cannot send its result (",
                                                       std::strerror(status - kReaderCannotSend), ")"));
    }
    // The system's loader, or a library before main(), got no memory or no thread.
    return absl::ResourceExhaustedError(absl::StrCat(path_, ": the process that reads it ended with status ", status,
                                                     "; the system has too little memory, or too few threads"));
  }
  if (status == SIGXCPU) {
    return Damaged(absl::StrCat(", or needs more than ", limits_.seconds, " seconds of processor time to read"));
  }
  if (status == SIGKILL) {
    return absl::ResourceExhaustedError(
        absl::StrCat(path_, ": the process that read it was killed, as systems do when memory is short"));
  }
  return Damaged(absl::StrCat(": the library that read it ends with signal ", status, " (", strsignal(status), ")"));
}

}  // namespace latvox::client
