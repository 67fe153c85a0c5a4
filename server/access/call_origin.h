// The origin of a call, for the log, the metrics, and the client's share of the server.
#ifndef LATVOX_SERVER_ACCESS_CALL_ORIGIN_H_
#define LATVOX_SERVER_ACCESS_CALL_ORIGIN_H_

#include <optional>
#include <string>

#include "server/access/caller.h"
#include "server/access/trace_context.h"

namespace latvox {

struct CallOrigin {
  std::string method;      // "Voxelize"
  std::string request_id;  // unique among all calls of all servers
  std::string peer;        // as gRPC names it
  Caller caller;
  std::optional<TraceContext> trace;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_ACCESS_CALL_ORIGIN_H_
