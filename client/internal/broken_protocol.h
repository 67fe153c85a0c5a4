// The error of an answer that breaks the protocol. Internal to the SDK.
#ifndef LATVOX_CLIENT_INTERNAL_BROKEN_PROTOCOL_H_
#define LATVOX_CLIENT_INTERNAL_BROKEN_PROTOCOL_H_

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "client/internal/printable.h"

namespace latvox::client {

template <class... Parts>
absl::Status Broken(const Parts&... parts) {
  return absl::DataLossError(Printable(absl::StrCat("the server broke the protocol: ", parts...)));
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_BROKEN_PROTOCOL_H_
