// Options of a Client's connections.
#ifndef LATVOX_LATVOX_CONNECTION_OPTIONS_H_
#define LATVOX_LATVOX_CONNECTION_OPTIONS_H_

#include "absl/time/time.h"
#include "latvox/credentials.h"

namespace latvox::client {

// All are optional. During calls, a server gets a ping after `keepalive_time` without a byte from it. A server that
// does not answer within `keepalive_timeout` is dead. Its calls go on elsewhere, or end with UNAVAILABLE.
struct ConnectionOptions {
  absl::Duration keepalive_time = absl::Seconds(5);      // silence before a ping
  absl::Duration keepalive_timeout = absl::Seconds(10);  // silence after the ping
  absl::Duration connect_timeout = absl::Seconds(5);     // for one attempt to connect to one address
  Credentials credentials = {};                          // of the client, and required of the server
};

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_CONNECTION_OPTIONS_H_
