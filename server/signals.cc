#include "server/signals.h"

#include <sys/prctl.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <thread>
#include <utility>

namespace latvox {
namespace {

// Sent by the kernel when a thread of the parent that forked ends, which need not be the parent's end.
constexpr int kParentSignal = SIGUSR1;

sigset_t WaitedFor() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGHUP);
  sigaddset(&signals, kParentSignal);
  return signals;
}

int NextSignal() {
  const sigset_t signals = WaitedFor();
  int signal = 0;
  while (sigwait(&signals, &signal) != 0) {
  }
  return signal;
}

}  // namespace

StopSignals::StopSignals(std::optional<pid_t> parent) : parent_(parent) {
  const sigset_t signals = WaitedFor();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  signal(SIGPIPE, SIG_IGN);
  if (parent_) prctl(PR_SET_PDEATHSIG, kParentSignal);
}

std::string StopSignals::Wait(const std::function<void()>& reload) const {
  // The parent may have ended before prctl.
  while (!parent_ || getppid() == *parent_) {
    const int signal = NextSignal();
    if (signal == SIGTERM) return "SIGTERM";
    if (signal == SIGINT) return "SIGINT";
    if (signal == SIGHUP) reload();
  }
  return "parent-exit";
}

void StopSignals::ExitOnNext(std::function<void()> last_words) const {
  std::thread([last_words = std::move(last_words)] {
    for (int signal = 0; signal != SIGTERM && signal != SIGINT;) signal = NextSignal();
    last_words();
    std::_Exit(1);
  }).detach();
}

}  // namespace latvox
