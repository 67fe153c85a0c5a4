#include "server/base/signals.h"

#include <sys/prctl.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"

namespace latvox {
namespace {

// The kernel sends it when the thread of the parent that forked this process ends. The parent itself may go on.
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

// 0 if the process is outside this namespace, or has ended.
pid_t ParentOf(pid_t process) {
  std::string status;
  std::getline(std::ifstream(absl::StrCat("/proc/", process, "/stat")), status, '\0');
  char state;
  pid_t parent = 0;
  const size_t name_end = status.rfind(')');  // names may hold any character
  if (name_end != std::string::npos) std::sscanf(status.c_str() + name_end + 1, " %c %d", &state, &parent);
  return parent;
}

}  // namespace

bool IsAncestor(pid_t process) {
  pid_t ancestor = getppid();
  if (ancestor == 0) return true;
  while (ancestor > 1 && ancestor != process) ancestor = ParentOf(ancestor);
  return ancestor == process;
}

StopSignals::StopSignals(std::optional<pid_t> parent) : parent_(parent) {
  const sigset_t signals = WaitedFor();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  signal(SIGPIPE, SIG_IGN);
  if (parent_) prctl(PR_SET_PDEATHSIG, kParentSignal);
}

std::string StopSignals::Wait(const std::function<void()>& reload) const {
  // The parent may have ended before the call of prctl.
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
