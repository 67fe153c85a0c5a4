// gRPC channels of the SDK. Internal to the SDK.
#ifndef LATVOX_CLIENT_INTERNAL_CHANNEL_H_
#define LATVOX_CLIENT_INTERNAL_CHANNEL_H_

#include <grpcpp/channel.h>

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "latvox/connection_options.h"

namespace latvox::client {

// Returns a channel to "HOST:PORT" or "unix:PATH", not yet connected. Calls go in turn to all reachable addresses of
// HOST. Errors: as MakeChannelCredentials.
absl::StatusOr<std::shared_ptr<grpc::Channel>> MakeChannel(const std::string& address,
                                                           const ConnectionOptions& options);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_CHANNEL_H_
