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

// Returns the credentials for a channel to `address`. Errors: INVALID_ARGUMENT naming a file that cannot be used, or
// the address if it is on another machine and the token would go there in plain text.
absl::StatusOr<std::shared_ptr<grpc::ChannelCredentials>> MakeChannelCredentials(const std::string& address,
                                                                                 const Credentials& credentials);

// Adds the token, and the trace of the call, to the metadata of a call. Call it once for each context.
void AddCallMetadata(const Credentials& credentials, const CallOptions& options, grpc::ClientContext& context);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_CHANNEL_SECURITY_H_
