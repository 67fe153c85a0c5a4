#include "client/internal/address.h"

#include <arpa/inet.h>

#include <cstdint>
#include <string>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"

namespace latvox::client {

absl::Status CheckAddress(absl::string_view address) {
  constexpr absl::string_view kSchemes[] = {"unix:", "unix-abstract:", "dns:", "ipv4:", "ipv6:", "vsock:", "xds:"};
  const auto wrong = [address](absl::string_view why) {
    return absl::InvalidArgumentError(
        absl::StrCat("address: \"", address, "\" ", why, "; it is HOST:PORT or unix:PATH"));
  };
  if (address.empty()) return wrong("is empty");
  if (absl::StartsWith(address, "http://") || absl::StartsWith(address, "https://")) return wrong("is a URL");
  for (const absl::string_view scheme : kSchemes) {
    if (absl::StartsWith(address, scheme)) return absl::OkStatus();
  }
  const size_t colon = address.rfind(':');
  if (colon == absl::string_view::npos || colon == 0) return wrong("has no port");
  constexpr uint32_t kMostPort = 65535;
  uint32_t port = 0;
  if (!absl::SimpleAtoi(address.substr(colon + 1), &port) || port == 0 || port > kMostPort) {
    return wrong("has no port from 1 to 65535");
  }
  return absl::OkStatus();
}

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
