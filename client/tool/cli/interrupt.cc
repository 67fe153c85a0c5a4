#include "client/tool/cli/interrupt.h"

#include <poll.h>
#include <signal.h>
#include <sys/eventfd.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string_view>

#include "client/mesh_files/input.h"
#include "client/tool/cli/exit_status.h"
#include "client/tool/output/atomic_file.h"

namespace latvox::client {
namespace {

sigset_t Signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&set, signal);
  return set;
}

// `timeout` sends its signal to the process and then to its group, so one interrupt may arrive twice.
constexpr std::chrono::milliseconds kOne(200);

[[noreturn]] void EndAtOnce() {
  RemoveTemporaryFiles();
  // No stdio: another thread may hold its lock in a write to a pipe that nobody reads. poll() comes first, because a
  // write to such a pipe would wait.
  constexpr std::string_view kLine = "latvox: cancelled\n";
  pollfd error{STDERR_FILENO, POLLOUT, 0};
  if (poll(&error, 1, 0) > 0 && write(STDERR_FILENO, kLine.data(), kLine.size()) < 0) {
    // There is nowhere to report this error.
  }
  _exit(static_cast<int>(ExitStatus::kCancelled));
}

}  // namespace

Interrupt::Interrupt(const Cancellation& cancellation) {
  const sigset_t set = Signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  signals_ = signalfd(-1, &set, SFD_CLOEXEC);
  stop_ = eventfd(0, EFD_CLOEXEC);
  watcher_ = std::thread([this, cancellation] { Watch(cancellation); });
}

Interrupt::~Interrupt() {
  const uint64_t one = 1;
  if (write(stop_, &one, sizeof(one)) == sizeof(one)) watcher_.join();
  close(signals_);
  close(stop_);
  const sigset_t set = Signals();
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
}

void Interrupt::Watch(const Cancellation& cancellation) const {
  pollfd sources[] = {{signals_, POLLIN, 0}, {stop_, POLLIN, 0}};
  using Clock = std::chrono::steady_clock;
  std::optional<Clock::time_point> first;
  for (;;) {
    if (poll(sources, 2, -1) < 0) continue;
    if (sources[1].revents != 0) return;
    signalfd_siginfo info;
    if (read(signals_, &info, sizeof(info)) != sizeof(info)) continue;
    const Clock::time_point now = Clock::now();
    if (first && now < *first + kOne) continue;
    if (cancellation.cancelled()) EndAtOnce();
    cancellation.Cancel();
    StopReading();
    first = now;
  }
}

}  // namespace latvox::client
