#include "server/access/caller.h"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <algorithm>
#include <cstring>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/strip.h"

namespace latvox {
namespace {

constexpr size_t kNetworkBytes = 8;  // of an IPv6 address

std::string NetworkOf(const std::string& host) {
  in6_addr address{};
  // A link-local address may have a zone, which inet_pton does not know.
  if (inet_pton(AF_INET6, host.substr(0, host.find('%')).c_str(), &address) != 1) return host;
  std::fill(std::begin(address.s6_addr) + kNetworkBytes, std::end(address.s6_addr), uint8_t{0});
  char text[INET6_ADDRSTRLEN];
  return absl::StrCat(inet_ntop(AF_INET6, &address, text, sizeof text), "/64");
}

template <class T>
T Least(T limit, T own) {
  return own == 0 ? limit : std::min(limit, own);
}

}  // namespace

std::string HostOf(absl::string_view peer) {
  if (absl::StartsWith(peer, "unix")) return "unix";
  const absl::string_view host_and_port = peer.substr(peer.find(':') + 1);
  const absl::string_view host = host_and_port.substr(0, host_and_port.rfind(':'));
  if (absl::StartsWith(peer, "ipv4:")) return std::string{host};
  if (!absl::StartsWith(peer, "ipv6:")) return std::string{peer};
  std::string plain = absl::StrReplaceAll(host, {{"%5B", "["}, {"%5D", "]"}, {"%25", "%"}});
  return NetworkOf(std::string{absl::StripSuffix(absl::StripPrefix(plain, "["), "]")});
}

Limits LimitsOf(const Caller& caller, Limits limits) {
  limits.max_mesh_bytes = Least(limits.max_mesh_bytes, caller.limits.max_mesh_bytes);
  limits.max_triangles = Least(limits.max_triangles, caller.limits.max_triangles);
  if (const uint64_t seconds = caller.limits.max_job_seconds; seconds != 0)
    limits.max_job_time = std::min(limits.max_job_time, absl::Seconds(seconds));
  limits.max_jobs_per_client = Least(limits.max_jobs_per_client, caller.limits.max_jobs);
  return limits;
}

}  // namespace latvox
