// What the text of a server's address says. Internal to the SDK.
#ifndef LATVOX_CLIENT_INTERNAL_ADDRESS_H_
#define LATVOX_CLIENT_INTERNAL_ADDRESS_H_

#include "absl/strings/string_view.h"

namespace latvox::client {

bool IsUnixSocket(absl::string_view address);

// Returns whether messages to the address cannot leave this machine. Only the plain forms of local addresses count.
bool IsLocalAddress(absl::string_view address);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_ADDRESS_H_
