// What calls have in common.
#ifndef LATVOX_SERVER_CALL_H_
#define LATVOX_SERVER_CALL_H_

#include <grpcpp/server_context.h>
#include <grpcpp/support/status.h>
#include <oneapi/tbb/task_arena.h>

#include "absl/status/status.h"
#include "server/call_registry.h"
#include "server/limits.h"
#include "server/mesh_decoder.h"
#include "server/metrics.h"

namespace latvox {

// What all calls share, but for the limits, which are the caller's. What is referred to must outlive them.
struct CallEnvironment {
  Limits limits;
  const MeshDecoder& decoder;
  oneapi::tbb::task_arena& arena;
  CallRegistry& registry;
  Metrics& metrics;
};

// The status as it is sent. For one that is not OK, before it is sent: a client that retries by itself is told when to,
// or (-1) that it is of no use.
grpc::Status StatusForClient(const absl::Status& status, grpc::CallbackServerContext& context);

// Why gRPC has cancelled the call.
absl::Status CancellationOf(const grpc::CallbackServerContext& context);

}  // namespace latvox

#endif  // LATVOX_SERVER_CALL_H_
