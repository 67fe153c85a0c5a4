// SIGINT, SIGTERM and SIGHUP as a cancellation.
#ifndef LATVOX_CLIENT_TOOL_CLI_INTERRUPT_H_
#define LATVOX_CLIENT_TOOL_CLI_INTERRUPT_H_

#include <thread>

#include "latvox/cancellation.h"

namespace latvox::client {

// While the object lives, the first such signal cancels. A later one ends the process at once and removes the files
// that it was writing. Create it before any other thread, because threads inherit the blocked signals. Programs started
// meanwhile must unblock them.
class Interrupt {
 public:
  explicit Interrupt(const Cancellation& cancellation);
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

 private:
  void Watch(const Cancellation& cancellation) const;

  int signals_, stop_;  // file descriptors
  std::thread watcher_;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_INTERRUPT_H_
