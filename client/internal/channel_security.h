// Credentials in gRPC's terms. Internal to the SDK.
#ifndef LATVOX_CLIENT_INTERNAL_CHANNEL_SECURITY_H_
#define LATVOX_CLIENT_INTERNAL_CHANNEL_SECURITY_H_

#include <grpcpp/client_context.h>
#include <grpcpp/security/credentials.h>

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "latvox/call_options.h"
#include "latvox/credentials.h"

namespace latvox::client {

// For a channel to `address`. Errors: INVALID_ARGUMENT naming the file that cannot be used, or the address if it is not
// of this machine and the token would go there in plain text.
absl::StatusOr<std::shared_ptr<grpc::ChannelCredentials>> MakeChannelCredentials(const std::string& address,
                                                                                 const Credentials& credentials);

// What each call on such a channel has in its metadata: the token, and the trace it belongs to. Once for each context.
void AddCallMetadata(const Credentials& credentials, const CallOptions& options, grpc::ClientContext& context);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_CHANNEL_SECURITY_H_
