// The caller of an RPC.
#ifndef LATVOX_SERVER_ACCESS_CALLER_H_
#define LATVOX_SERVER_ACCESS_CALLER_H_

#include <cstdint>
#include <string>

#include "absl/strings/string_view.h"
#include "server/base/limits.h"

namespace latvox {

// Limits of one token, besides those of the server. 0: no limit.
struct CallerLimits {
  uint32_t max_jobs = 0;  // at once, for all its calls
  uint64_t max_mesh_bytes = 0;
  uint64_t max_triangles = 0;
  uint64_t max_job_seconds = 0;  // of CPU time
};

struct Caller {
  std::string name;    // of the token, else of the client's certificate; empty: the server asked for neither
  std::string client;  // the client that the call counts for: `name`, else the host that it came from
  CallerLimits limits;
};

// Returns the host of a peer as gRPC names it: "ipv4:10.0.0.1:4711" is "10.0.0.1". Only the first 64 bits of an IPv6
// address count, because the client chooses the others. All Unix sockets are "unix".
std::string HostOf(absl::string_view peer);

// Returns the limits that a call of this caller must keep.
Limits LimitsOf(const Caller& caller, Limits limits);

}  // namespace latvox

#endif  // LATVOX_SERVER_ACCESS_CALLER_H_
