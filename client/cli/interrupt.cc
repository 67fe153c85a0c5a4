#include "client/cli/interrupt.h"

#include <poll.h>
#include <signal.h>
#include <sys/eventfd.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>

#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "client/cli/exit_status.h"
#include "client/mesh/input.h"
#include "client/output/atomic_file.h"

namespace latvox::client {
namespace {

sigset_t Signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&set, signal);
  return set;
}

// `timeout` sends its signal to the process and then to its group.
constexpr absl::Duration kOne = absl::Milliseconds(200);

[[noreturn]] void EndAtOnce() {
  RemoveTemporaryFiles();
  std::fputs("latvox: cancelled\n", stderr);
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
  absl::Time first = absl::InfinitePast();
  for (;;) {
    if (poll(sources, 2, -1) < 0) continue;
    if (sources[1].revents != 0) return;
    signalfd_siginfo info;
    if (read(signals_, &info, sizeof(info)) != sizeof(info)) continue;
    const absl::Time now = absl::Now();
    if (now < first + kOne) continue;
    if (cancellation.cancelled()) EndAtOnce();
    cancellation.Cancel();
    StopReading();
    first = now;
  }
}

}  // namespace latvox::client
