// The tries of one call: their servers, their times, and their end. Internal to the SDK.
#ifndef LATVOX_CLIENT_INTERNAL_TRIES_H_
#define LATVOX_CLIENT_INTERNAL_TRIES_H_

#include <vector>

#include "absl/status/status.h"
#include "client/internal/attempt.h"
#include "client/internal/connection.h"
#include "latvox/call_options.h"

namespace latvox::client {

// As RetryPolicy describes. Used by the thread that makes the call.
class Tries {
 public:
  // `mesh`, if given: the mesh that the server should have. All must outlive it.
  Tries(Connection& connection, const CallOptions& options, const MeshId* mesh = nullptr);

  // The server of the present try.
  size_t server() const { return server_; }

  // The present try has made progress.
  void Progress();

  // The present try has ended with this error. OK: server() is the next one, and it is time for it. Errors, with which
  // the call ends: that of the try; CANCELLED; DEADLINE_EXCEEDED.
  absl::Status Again(const AttemptEnd& end);

 private:
  absl::Status Wait(absl::Duration duration, const absl::Status& because) const;
  absl::Duration Jitter() const;

  Connection& connection_;
  const CallOptions& options_;
  const MeshId* mesh_;
  size_t server_ = 0;
  // In the present round:
  std::vector<bool> tried_;
  absl::Duration asked_for_ = absl::ZeroDuration();
  // Since the last progress:
  int rounds_ = 0, failures_ = 0;
};

// Calls once(server), which returns an AttemptEnd, until it succeeds or another try is useless.
template <class Once>
absl::Status Repeat(Connection& connection, const CallOptions& options, const Once& once) {
  if (options.cancellation.cancelled()) return CancelledByCaller();
  for (Tries tries(connection, options);;) {
    const AttemptEnd end = once(tries.server());
    if (end.status.ok()) return absl::OkStatus();
    if (absl::Status status = tries.Again(end); !status.ok()) return status;
  }
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_TRIES_H_
