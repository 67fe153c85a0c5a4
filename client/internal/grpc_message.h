// Messages of gRPC, in words for people. Internal to the SDK.
#ifndef LATVOX_CLIENT_INTERNAL_GRPC_MESSAGE_H_
#define LATVOX_CLIENT_INTERNAL_GRPC_MESSAGE_H_

#include <grpcpp/support/status.h>

#include <string>

#include "absl/strings/string_view.h"

namespace latvox::client {

// Returns why gRPC lost a connection, or got none, in one line without gRPC's own codes. For several addresses, gRPC
// names the last one.
std::string ConnectionReason(absl::string_view message);

// Returns the message of a call that failed. It is never empty, although gRPC's own message may be.
std::string MessageOf(const grpc::Status& status);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_GRPC_MESSAGE_H_
