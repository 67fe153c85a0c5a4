// Serves metrics over HTTP, as Prometheus fetches them: GET /metrics.
#ifndef LATVOX_SERVER_LISTEN_METRICS_SERVER_H_
#define LATVOX_SERVER_LISTEN_METRICS_SERVER_H_

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "server/calls/metrics.h"

namespace latvox {

class MetricsServer {
 public:
  // Serves when it returns, in plain text and to everybody who can reach the address. The address is HOST:PORT with an
  // IP address as the host; port 0 takes any free port. `metrics` must outlive the object. Errors: UNAVAILABLE naming
  // the address.
  static absl::StatusOr<std::unique_ptr<MetricsServer>> Start(const std::string& address, const Metrics& metrics);

  virtual ~MetricsServer() = default;

  // The given address, with the port that was chosen.
  virtual const std::string& address() const = 0;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_LISTEN_METRICS_SERVER_H_
