// Signals that ask the process to stop, or to read its configuration again.
#ifndef LATVOX_SERVER_BASE_SIGNALS_H_
#define LATVOX_SERVER_BASE_SIGNALS_H_

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>

namespace latvox {

// Returns whether a process is this one's parent, or its parent's, and so on. Returns true if the parent is in another
// pid namespace, where this process cannot see it.
bool IsAncestor(pid_t process);

// Waits for SIGTERM, SIGINT and SIGHUP instead of handling them. So no code runs in a signal handler, and a process
// with the id 1 gets them, too: the kernel delivers to it only the signals that it asks for. Only one object can exist.
class StopSignals {
 public:
  // Blocks the signals in this thread and in all threads that it starts later, so construct it before any thread. If
  // `parent` is set, the parent's end is a request to stop as well, even if it came earlier. Ignores SIGPIPE.
  explicit StopSignals(std::optional<pid_t> parent);

  // Blocks until the process is asked to stop; returns the reason in a word. Meanwhile runs `reload` at each SIGHUP.
  std::string Wait(const std::function<void()>& reload) const;

  // From now on, the next request to stop runs `last_words`, and ends the process at once with exit status 1.
  void ExitOnNext(std::function<void()> last_words) const;

 private:
  const std::optional<pid_t> parent_;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_BASE_SIGNALS_H_
