#include "client/internal/address.h"

#include <arpa/inet.h>

#include <string>

#include "absl/strings/match.h"

namespace latvox::client {

bool IsUnixSocket(absl::string_view address) {
  return absl::StartsWith(address, "unix:") || absl::StartsWith(address, "unix-abstract:");
}

bool IsLocalAddress(absl::string_view address) {
  if (IsUnixSocket(address)) return true;
  const std::string host{address.substr(0, address.rfind(':'))};
  in_addr v4{};
  if (inet_pton(AF_INET, host.c_str(), &v4) == 1) return (ntohl(v4.s_addr) >> 24) == 127;
  return host == "localhost" || host == "[::1]";
}

}  // namespace latvox::client
