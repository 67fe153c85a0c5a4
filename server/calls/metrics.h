// The server's metrics, for Prometheus. Names: https://prometheus.io/docs/practices/naming
#ifndef LATVOX_SERVER_CALLS_METRICS_H_
#define LATVOX_SERVER_CALLS_METRICS_H_

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "server/calls/request_log.h"

namespace prometheus {
class Collectable;
}

namespace latvox {

// Thread-safe; Record holds locks briefly.
//
// Other objects' figures are read on request, by one line:
//   metrics.AddGauge("latvox_jobs_queued", "Jobs that wait for their turn.", [&] { return registry.queued(); });
class Metrics {
 public:
  using Read = std::function<double()>;
  using Labels = std::map<std::string, std::string>;

  Metrics();
  ~Metrics();
  Metrics(const Metrics&) = delete;
  Metrics& operator=(const Metrics&) = delete;

  // Counts a finished call.
  void Record(const RequestRecord& record);

  // `read` must be thread-safe, quick, and callable until this object dies. Gauges with the same name differ in their
  // labels. A counter never falls.
  void AddGauge(const std::string& name, const std::string& help, Read read, const Labels& labels = {});
  void AddCounter(const std::string& name, const std::string& help, Read read, const Labels& labels = {});

  // All metrics, for a server of metrics.
  std::shared_ptr<prometheus::Collectable> collectable() const;

  // All metrics, in Prometheus's text format.
  std::string Text() const;

 private:
  struct Families;
  const std::unique_ptr<Families> families_;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_CALLS_METRICS_H_
