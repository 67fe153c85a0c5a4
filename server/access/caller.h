// Who calls.
#ifndef LATVOX_SERVER_ACCESS_CALLER_H_
#define LATVOX_SERVER_ACCESS_CALLER_H_

#include <cstdint>
#include <string>

#include "absl/strings/string_view.h"
#include "server/base/limits.h"

namespace latvox {

// Limits of one token, besides those of the server. 0: none.
struct CallerLimits {
  uint32_t max_jobs = 0;  // at once, of all its calls
  uint64_t max_mesh_bytes = 0;
  uint64_t max_triangles = 0;
};

struct Caller {
  std::string name;    // of the token, else of the client's certificate; empty: neither was asked for
  std::string client;  // whose share of the server the call takes: name, else the host that it came from
  CallerLimits limits;
};

// The host of a peer as gRPC names it: "ipv4:10.0.0.1:4711" is "10.0.0.1". Of an IPv6 address only the first 64 bits
// count, for the others are the client's to choose. "unix" for all on Unix sockets.
std::string HostOf(absl::string_view peer);

// The limits that a call of this caller is held against.
Limits LimitsOf(const Caller& caller, Limits limits);

}  // namespace latvox

#endif  // LATVOX_SERVER_ACCESS_CALLER_H_
