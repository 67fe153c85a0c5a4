// The number and timing of further tries of a call.
#ifndef LATVOX_LATVOX_RETRY_POLICY_H_
#define LATVOX_LATVOX_RETRY_POLICY_H_

#include "absl/time/time.h"

namespace latvox::client {

// A repeated call is always safe here: every answer is a function of its request, and storing a mesh is idempotent. So
// calls are repeated wherever that can help: the server went away or is stopping, the connection broke, or the server
// is full and gave a time to come back. They are not repeated after any other answer of a server, and never after
// CallOptions.deadline.
//
// A round asks every reachable server of the Client once, one right after the other. Between two rounds, the call waits
// a random time below `first_wait`, which doubles with every round up to `longest_wait`. It waits at least as long as
// the servers asked for. CallOptions.cancellation ends the wait at once.
struct RetryPolicy {
  // Rounds after the first one without progress; after bricks were passed on, the count begins anew. 0: only one try.
  int max_retries = 10;
  absl::Duration first_wait = absl::Milliseconds(100);  // the longest wait between the first two rounds
  absl::Duration longest_wait = absl::Seconds(5);       // the longest wait between any two
};

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_RETRY_POLICY_H_
