// How the server shares out the machine: memory, threads and decoder processes.
#ifndef LATVOX_SERVER_LISTEN_SHARES_H_
#define LATVOX_SERVER_LISTEN_SHARES_H_

#include <cstdint>

#include "absl/status/statusor.h"
#include "server/decode/decoder_pool.h"
#include "server/listen/server.h"

namespace latvox {

inline constexpr uint64_t kGrpcShare = 8;  // gRPC's quota is this part of the memory

// Returns the options with the memory divided: the whole in memory_bytes, the part of jobs in
// limits.memory_budget_bytes. Errors: INVALID_ARGUMENT: too little is left for jobs.
absl::StatusOr<ServerOptions> WithMemoryShared(ServerOptions options);

// Returns the number of compute threads.
int ThreadsOf(const ServerOptions& options);

// Returns the options of the decoders, with the number of processes and the memory of each.
DecoderOptions DecodersOf(const ServerOptions& options);

}  // namespace latvox

#endif  // LATVOX_SERVER_LISTEN_SHARES_H_
