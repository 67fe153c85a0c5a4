#include "server/guard/host_budgets.h"

#include <netinet/in.h>

#include <algorithm>
#include <cstring>

namespace latvox {
namespace {

constexpr size_t kNetworkBytes = 8;  // of an IPv6 address
constexpr size_t kFewHosts = 64;

}  // namespace

std::string HostKey(const sockaddr_storage& address) {
  if (address.ss_family == AF_INET) {
    const auto& v4 = reinterpret_cast<const sockaddr_in&>(address).sin_addr;
    return {reinterpret_cast<const char*>(&v4), sizeof v4};
  }
  if (address.ss_family != AF_INET6) return "";
  const auto& v6 = reinterpret_cast<const sockaddr_in6&>(address).sin6_addr;
  const auto* bytes = reinterpret_cast<const char*>(&v6);
  constexpr size_t kV4Bytes = sizeof(in_addr);
  if (IN6_IS_ADDR_V4MAPPED(&v6)) return {bytes + sizeof v6 - kV4Bytes, kV4Bytes};
  return {bytes, kNetworkBytes};
}

std::shared_ptr<HostBudget> HostBudgets::Of(const std::string& host, absl::Time now) {
  const std::lock_guard lock(mu_);
  if (const auto known = hosts_.find(host); known != hosts_.end()) return known->second;
  if (hosts_.size() >= forget_at_) {
    std::erase_if(hosts_, [now](const auto& item) { return item.second.use_count() == 1 && item.second->Full(now); });
    forget_at_ = std::max(kFewHosts, 2 * hosts_.size());
  }
  return hosts_[host] = std::make_shared<HostBudget>(per_second_, now);
}

}  // namespace latvox
