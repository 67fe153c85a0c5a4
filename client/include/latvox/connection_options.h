// How a Client connects.
#ifndef LATVOX_LATVOX_CONNECTION_OPTIONS_H_
#define LATVOX_LATVOX_CONNECTION_OPTIONS_H_

#include "absl/time/time.h"
#include "latvox/credentials.h"

namespace latvox::client {

// All may be left out. While calls are under way, a server gets a ping after `keepalive_time` without a byte from it;
// one that does not answer within `keepalive_timeout` is dead, and its calls go on elsewhere, or end with UNAVAILABLE.
struct ConnectionOptions {
  absl::Duration keepalive_time = absl::Seconds(5);      // silence before a ping
  absl::Duration keepalive_timeout = absl::Seconds(10);  // silence after it
  absl::Duration connect_timeout = absl::Seconds(5);     // one attempt to connect to one address
  Credentials credentials = {};                          // what to show, and to want to see
};

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_CONNECTION_OPTIONS_H_
