#include "server/base/endpoint.h"

#include <arpa/inet.h>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "server/base/unix_socket.h"

namespace latvox {
namespace {

// Without the brackets of an IPv6 address.
absl::string_view HostPart(absl::string_view address) {
  if (absl::ConsumePrefix(&address, "[")) return address.substr(0, address.find(']'));
  return address.substr(0, address.rfind(':'));
}

bool IsDecimal(absl::string_view text) { return text.find_first_not_of("0123456789") == absl::string_view::npos; }

bool IsLoopback(const std::string& host) {
  in_addr v4{};
  if (inet_pton(AF_INET, host.c_str(), &v4) == 1) return (ntohl(v4.s_addr) >> 24) == 127;
  in6_addr v6{};
  if (inet_pton(AF_INET6, host.c_str(), &v6) == 1) {
    return IN6_IS_ADDR_LOOPBACK(&v6) || (IN6_IS_ADDR_V4MAPPED(&v6) && v6.s6_addr[12] == 127);
  }
  return host == "localhost";
}

}  // namespace

bool IsUnixSocket(absl::string_view address) {
  return absl::StartsWith(address, "unix:") || absl::StartsWith(address, "unix-abstract:");
}

bool IsLocal(const std::string& address) { return IsUnixSocket(address) || IsLoopback(std::string{HostPart(address)}); }

absl::Status CheckProtected(const std::string& address, bool tls, bool insecure) {
  if (tls && insecure) {
    return absl::InvalidArgumentError("--insecure and --tls-cert contradict each other: give one of them");
  }
  if (tls || insecure || IsLocal(address)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("refusing to listen on ", address,
                   " in plain text, for others than this machine can reach it: give --tls-cert and --tls-key, or, if "
                   "something else protects it, --insecure"));
}

absl::Status CheckAddress(const std::string& address) {
  if (IsUnixSocket(address)) {
    if (!absl::StrContains(address, '%')) return absl::OkStatus();
    return absl::InvalidArgumentError(absl::StrCat("cannot listen on ", address, ": gRPC takes a % for an escape"));
  }
  constexpr int kMostPort = 65535;
  const size_t colon = address.rfind(':');
  const absl::string_view host = HostPart(address);
  const bool in_brackets = absl::StartsWith(address, "[");
  int port = 0;
  const bool is_good = colon != std::string::npos && IsDecimal(address.substr(colon + 1)) &&
                       absl::SimpleAtoi(address.substr(colon + 1), &port) && port <= kMostPort &&
                       (in_brackets ? colon == host.size() + 2 : !absl::StrContains(host, ':'));
  if (is_good) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("cannot listen on \"", address,
                                                 "\": that is neither HOST:PORT, with a port up to ", kMostPort,
                                                 ", nor unix:PATH"));
}

std::string BoundAddress(const std::string& address, int port) {
  if (SocketPathOf(address) || !absl::EndsWith(address, ":0")) return address;
  return absl::StrCat(address.substr(0, address.size() - 1), port);
}

absl::Status CannotListen(const std::string& address, absl::string_view why) {
  return absl::UnavailableError(absl::StrCat("cannot listen on ", address, ": ", why));
}

void WithoutCompression(grpc::ServerBuilder& builder) {
  for (const grpc_compression_algorithm algorithm : {GRPC_COMPRESS_DEFLATE, GRPC_COMPRESS_GZIP}) {
    builder.SetCompressionAlgorithmSupportStatus(algorithm, false);
  }
}

absl::Status CheckAddressIsFree(const std::string& address) {
  const auto path = SocketPathOf(address);
  if (!path) return absl::OkStatus();
  const absl::Status status = CheckSocketPathIsFree(*path);
  return status.ok() ? status : CannotListen(address, status.message());
}

}  // namespace latvox
