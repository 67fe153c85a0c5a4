#include "server/decode/decoder_process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <ctime>
#include <iterator>
#include <vector>

#include "absl/strings/str_cat.h"
#include "deploy/process/child.h"
#include "server/decode/decoder_worker.h"

namespace latvox {
namespace {

absl::Status Failed(absl::string_view what, int error) {
  return absl::InternalError(absl::StrCat("cannot start a decoder process: ", what, ": ", std::strerror(error)));
}

// Returns errno. posix_spawn is safe in a process with other threads; fork is not.
int Spawn(const DecoderOptions& options, int channel, pid_t& pid) {
  std::string words[] = {"latvoxd", kDecoderArgument, absl::StrCat(getpid()), absl::StrCat(options.memory),
                         options.may_be_unconfined ? "unconfined" : "confined"};
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  char* no_environment[] = {nullptr};
  const ChildSetting setting({channel});
  return posix_spawn(&pid, options.program.c_str(), &setting.files, &setting.attributes, arguments.data(),
                     no_environment);
}

}  // namespace

bool ProcessEnd::is_crash() const {
  if (!by_signal) return true;
  for (const int signal : {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, SIGTRAP, SIGSYS, SIGXCPU, SIGXFSZ}) {
    if (status == signal) return true;
  }
  return false;
}

std::string ProcessEnd::ToString() const {
  return by_signal ? absl::StrCat("signal ", status, " (", strsignal(status), ")") : absl::StrCat("status ", status);
}

absl::StatusOr<std::unique_ptr<DecoderProcess>> DecoderProcess::Start(const DecoderOptions& options) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) return Failed("socketpair", errno);
  pid_t pid = -1;
  const int error = Spawn(options, ends[1], pid);
  close(ends[1]);
  if (error != 0) {
    close(ends[0]);
    return Failed(options.program, error);
  }
  // Debian 12's <sys/pidfd.h> does not link from C++.
  const int pidfd = static_cast<int>(syscall(SYS_pidfd_open, pid, 0));
  const int pidfd_error = errno;
  fcntl(ends[0], F_SETFL, O_NONBLOCK);
  std::unique_ptr<DecoderProcess> process(new DecoderProcess(pid, ends[0], pidfd));
  if (pidfd < 0) return Failed("pidfd_open", pidfd_error);
  return process;
}

DecoderProcess::~DecoderProcess() {
  if (!ended_) {
    Kill();
    ReceiveEnd(0);
  }
  close(channel_);
  if (pidfd_ >= 0) close(pidfd_);
}

// Until ReceiveEnd, the process id belongs to this process, whether it has ended or not.
void DecoderProcess::Kill() {
  if (!ended_) kill(pid_, SIGKILL);
}

std::optional<ProcessEnd> DecoderProcess::ReceiveEnd() { return ReceiveEnd(WNOHANG); }

std::optional<ProcessEnd> DecoderProcess::ReceiveEnd(int options) {
  siginfo_t info{};
  while (waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | options) != 0) {
    if (errno == EINTR) continue;
    ended_ = true;  // someone else has waited for it
    return ProcessEnd{};
  }
  if (info.si_pid == 0) return std::nullopt;
  ended_ = true;
  return ProcessEnd{info.si_code != CLD_EXITED, info.si_status};
}

absl::Duration DecoderProcess::CpuTime() const {
  clockid_t clock;
  timespec time{};
  if (clock_getcpuclockid(pid_, &clock) != 0 || clock_gettime(clock, &time) != 0) return absl::ZeroDuration();
  return absl::DurationFromTimespec(time);
}

void DecoderProcess::LimitAddressSpace(uint64_t bytes) {
  rlimit limit{};
  if (prlimit(pid_, RLIMIT_AS, nullptr, &limit) != 0) return;
  limit.rlim_cur = std::min<rlim_t>(bytes, limit.rlim_max);
  prlimit(pid_, RLIMIT_AS, &limit, nullptr);
}

}  // namespace latvox
