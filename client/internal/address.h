// The meaning of a server's address. Internal to the SDK.
#ifndef LATVOX_CLIENT_INTERNAL_ADDRESS_H_
#define LATVOX_CLIENT_INTERNAL_ADDRESS_H_

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace latvox::client {

// Returns whether it is HOST:PORT, unix:PATH, or has another scheme of gRPC's. Otherwise gRPC would guess the port, and
// might reach another service. Errors: INVALID_ARGUMENT naming the address.
absl::Status CheckAddress(absl::string_view address);

bool IsUnixSocket(absl::string_view address);

// Returns whether messages to the address cannot leave this machine. Only the plain forms of local addresses count.
bool IsLocalAddress(absl::string_view address);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_ADDRESS_H_
