// How often and how soon a call is tried again.
#ifndef LATVOX_LATVOX_RETRY_POLICY_H_
#define LATVOX_LATVOX_RETRY_POLICY_H_

#include "absl/time/time.h"

namespace latvox::client {

// Trying again is always safe here: every answer is a function of its request, and storing a mesh is idempotent. So it
// is done wherever it can help: the server went away or is stopping, the connection broke, or the server is full and
// said when to come back. Not after any other answer of a server, and never past CallOptions.deadline.
//
// A round asks every server of the Client that can be reached once, one right after the other. Between two rounds the
// call waits a random time below `first_wait`, which doubles with every round up to `longest_wait`, and at least as
// long as the servers asked for. CallOptions.cancellation ends the wait at once.
struct RetryPolicy {
  // Rounds after the first one, without progress: bricks that were handed on start the count anew. 0: one try is all.
  int max_retries = 10;
  absl::Duration first_wait = absl::Milliseconds(100);  // most, between the first two rounds
  absl::Duration longest_wait = absl::Seconds(5);       // most, between any two
};

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_RETRY_POLICY_H_
