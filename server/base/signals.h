// The signals by which the process is asked to stop, or to read its configuration again.
#ifndef LATVOX_SERVER_BASE_SIGNALS_H_
#define LATVOX_SERVER_BASE_SIGNALS_H_

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>

namespace latvox {

// Whether a process is this one's parent, or its parent's, and so on; true if the parent is out of sight, in another
// pid namespace.
bool IsAncestor(pid_t process);

// SIGTERM, SIGINT and SIGHUP, waited for instead of handled: no code runs in a signal handler, and a process with the
// id 1, to which the kernel delivers only what it asks for, gets them too. There can be one object only.
class StopSignals {
 public:
  // Blocks the signals in this thread and in all it starts later: construct it before any thread. If `parent` is set,
  // its end is a request to stop as well, also an earlier one. SIGPIPE is ignored.
  explicit StopSignals(std::optional<pid_t> parent);

  // Blocks until the process is asked to stop; returns why, in a word. Meanwhile runs `reload` at each SIGHUP.
  std::string Wait(const std::function<void()>& reload) const;

  // From now on, the next request to stop runs `last_words` and ends the process at once, with exit status 1.
  void ExitOnNext(std::function<void()> last_words) const;

 private:
  const std::optional<pid_t> parent_;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_BASE_SIGNALS_H_
