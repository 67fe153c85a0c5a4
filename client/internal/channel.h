// Channels as the SDK uses them. Internal to the SDK.
#ifndef LATVOX_CLIENT_INTERNAL_CHANNEL_H_
#define LATVOX_CLIENT_INTERNAL_CHANNEL_H_

#include <grpcpp/channel.h>

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "latvox/connection_options.h"

namespace latvox::client {

// A channel, not connected yet, to "HOST:PORT" or "unix:PATH". Calls go in turn to all addresses that HOST resolves to
// and that can be reached. Errors: as MakeChannelCredentials.
absl::StatusOr<std::shared_ptr<grpc::Channel>> MakeChannel(const std::string& address,
                                                           const ConnectionOptions& options);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_CHANNEL_H_
