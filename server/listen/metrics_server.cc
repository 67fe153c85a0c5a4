#include "server/listen/metrics_server.h"

#include <prometheus/collectable.h>
#include <prometheus/exposer.h>

#include <exception>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"

namespace latvox {
namespace {

// A silent client holds one of these threads no longer than the timeout.
const std::vector<std::string>& Settings() {
  static const auto& settings = *new std::vector<std::string>{"num_threads",       "8",  "request_timeout_ms", "1000",
                                                              "enable_keep_alive", "no", "max_request_size",   "8192"};
  return settings;
}

class PrometheusServer final : public MetricsServer {
 public:
  PrometheusServer(const std::string& address, std::shared_ptr<prometheus::Collectable> collectable)
      : collectable_(std::move(collectable)), exposer_(WithAddress(address)), address_(address) {
    exposer_.RegisterCollectable(collectable_);
    if (absl::EndsWith(address, ":0")) {
      address_ = absl::StrCat(address.substr(0, address.size() - 1), exposer_.GetListeningPorts().at(0));
    }
  }

  const std::string& address() const override { return address_; }

 private:
  static std::vector<std::string> WithAddress(const std::string& address) {
    std::vector<std::string> settings = Settings();
    settings.insert(settings.end(), {"listening_ports", address});
    return settings;
  }

  const std::shared_ptr<prometheus::Collectable> collectable_;
  prometheus::Exposer exposer_;
  std::string address_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<MetricsServer>> MetricsServer::Start(const std::string& address,
                                                                    const Metrics& metrics) {
  try {
    return std::make_unique<PrometheusServer>(address, metrics.collectable());
  } catch (const std::exception&) {  // its text is only "null context when constructing CivetServer"
    return absl::UnavailableError(
        absl::StrCat("cannot listen on ", address,
                     " for metrics: the address is in use, not of this machine, not permitted, "
                     "or no HOST:PORT with an IP address"));
  }
}

}  // namespace latvox
