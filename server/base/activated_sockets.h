// Sockets that systemd, or another service manager with its protocol, has opened for this process: sd_listen_fds(3).
#ifndef LATVOX_SERVER_BASE_ACTIVATED_SOCKETS_H_
#define LATVOX_SERVER_BASE_ACTIVATED_SOCKETS_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace latvox {

// A stream socket that listens, does not block, and closes in programs that this one starts.
struct ActivatedSocket {
  int fd = -1;          // the process's own, to its end
  std::string address;  // HOST:PORT, unix:PATH or unix-abstract:NAME
};

// Returns the sockets of $LISTEN_PID and $LISTEN_FDS; none if these name no or another process. Takes the protocol's
// variables out of the environment, so that decoder processes take nothing for theirs. Call it before any thread.
// Errors: INVALID_ARGUMENT naming the variable, or the descriptor and what is wrong with it.
absl::StatusOr<std::vector<ActivatedSocket>> TakeActivatedSockets();

}  // namespace latvox

#endif  // LATVOX_SERVER_BASE_ACTIVATED_SOCKETS_H_
