#include "server/calls/metrics.h"

#include <prometheus/collectable.h>
#include <prometheus/counter.h>
#include <prometheus/family.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>

#include <algorithm>
#include <mutex>
#include <utility>
#include <vector>

#include "core/base/simd.h"
#include "latvox/v1/voxelizer.pb.h"
#include "server/base/errors.h"
#include "server/base/process_facts.h"

namespace latvox {
namespace {

using Counters = prometheus::Family<prometheus::Counter>;
using Histograms = prometheus::Family<prometheus::Histogram>;
using prometheus::MetricType;

// Seconds. The bunny at 64 takes some 5 ms, a job at the limits minutes.
const prometheus::Histogram::BucketBoundaries& Buckets() {
  static const auto& buckets = *new prometheus::Histogram::BucketBoundaries{
      0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1, 2.5, 5, 10, 30, 60, 300};
  return buckets;
}

// Values that are read on request.
class Readings final : public prometheus::Collectable {
 public:
  void Add(MetricType type, const std::string& name, const std::string& help, Metrics::Read read,
           const Metrics::Labels& labels) {
    const std::lock_guard lock(mu_);
    auto found = std::find_if(families_.begin(), families_.end(), [&](const auto& it) { return it.name == name; });
    if (found == families_.end()) found = families_.insert(families_.end(), {type, name, help, {}});
    found->readings.push_back({labels, std::move(read)});
  }

  std::vector<prometheus::MetricFamily> Collect() const override {
    const std::lock_guard lock(mu_);
    std::vector<prometheus::MetricFamily> collected;
    for (const Family& family : families_) {
      prometheus::MetricFamily& out = collected.emplace_back();
      out.name = family.name;
      out.help = family.help;
      out.type = family.type;
      for (const Reading& reading : family.readings) {
        prometheus::ClientMetric& metric = out.metric.emplace_back();
        for (const auto& [name, value] : reading.labels) metric.label.push_back({name, value});
        (family.type == MetricType::Gauge ? metric.gauge.value : metric.counter.value) = reading.read();
      }
    }
    return collected;
  }

 private:
  struct Reading {
    Metrics::Labels labels;
    Metrics::Read read;
  };
  struct Family {
    MetricType type;
    std::string name, help;
    std::vector<Reading> readings;
  };

  mutable std::mutex mu_;
  std::vector<Family> families_;  // guarded by mu_
};

class Everything final : public prometheus::Collectable {
 public:
  std::vector<prometheus::MetricFamily> Collect() const override {
    std::vector<prometheus::MetricFamily> all = registry.Collect();
    for (prometheus::MetricFamily& family : readings.Collect()) all.push_back(std::move(family));
    return all;
  }

  prometheus::Registry registry;
  Readings readings;
};

// Counts calls that the server refuses or gives up. It does not count calls that the client or its deadline ends,
// defects of our own, or NOT_FOUND for a mesh that is not stored, which answers a question.
bool IsRejection(absl::StatusCode code) {
  switch (code) {
    case absl::StatusCode::kInvalidArgument:
    case absl::StatusCode::kResourceExhausted:
    case absl::StatusCode::kUnauthenticated:
    case absl::StatusCode::kUnavailable:
      return true;
    default:
      return false;
  }
}

// The metrics of one method. Family::Add makes an object before it looks for the one that is there.
struct MethodMetrics {
  std::map<absl::StatusCode, prometheus::Counter*> requests;
  prometheus::Counter *received = nullptr, *sent = nullptr;
  prometheus::Histogram* durations = nullptr;
};

}  // namespace

struct Metrics::Families {
  std::shared_ptr<Everything> everything = std::make_shared<Everything>();
  prometheus::Registry& registry = everything->registry;

  Counters& requests = Counter("latvox_requests_total", "Calls that are over, by method and status code.");
  Counters& rejections =
      Counter("latvox_rejections_total",
              "Calls that were refused or given up, by ErrorInfo.reason; MESH_NOT_FOUND is not counted.");
  Counters& received = Counter("latvox_received_bytes_total", "Bytes of meshes and drawings, by method.");
  Counters& sent = Counter("latvox_sent_bytes_total", "Bytes of messages that were sent, by method.");
  prometheus::Counter& triangles =
      Counter("latvox_triangles_total", "Triangles of meshes that were voxelized, decoded for it or kept.").Add({});
  prometheus::Counter& voxels = Counter("latvox_voxels_total", "Voxels found.").Add({});
  prometheus::Counter& pixels = Counter("latvox_pixels_total", "Pixels found.").Add({});
  Histograms& durations = Histogram("latvox_request_duration_seconds", "Time of calls that ended OK, by method.");
  Histograms& stages =
      Histogram("latvox_stage_duration_seconds",
                "Time that calls spent in each stage they came to: upload, queue, decode, voxelize "
                "(without waiting), stream (waiting for the client to take bricks, and then for another "
                "turn), pixelize.");
  prometheus::Histogram &upload = Stage("upload"), &queue = Stage("queue"), &decode = Stage("decode"),
                        &voxelize = Stage("voxelize"), &stream = Stage("stream"), &pixelize = Stage("pixelize");
  std::map<std::string, MethodMetrics> methods;

  Counters& Counter(const std::string& name, const std::string& help) {
    return prometheus::BuildCounter().Name(name).Help(help).Register(registry);
  }
  Histograms& Histogram(const std::string& name, const std::string& help) {
    return prometheus::BuildHistogram().Name(name).Help(help).Register(registry);
  }

  Families() { StartAtZero(); }

  // Creates every counter at 0, because rate() does not see the first event of a counter that appears with it.
  void StartAtZero() {
    const google::protobuf::ServiceDescriptor& service = *v1::VoxelizeRequest::descriptor()->file()->service(0);
    for (int n = 0; n < service.method_count(); ++n) {
      const std::string& method = service.method(n)->name();
      const Labels labels = {{"method", method}};
      MethodMetrics& of_method = methods[method];
      for (const absl::StatusCode code : kCodes) {
        of_method.requests[code] = &requests.Add({{"method", method}, {"code", absl::StatusCodeToString(code)}});
      }
      of_method.received = &received.Add(labels);
      of_method.sent = &sent.Add(labels);
      of_method.durations = &durations.Add(labels, Buckets());
    }
    for (const absl::string_view reason : kReasons) {
      if (reason != kMeshNotFound) rejections.Add({{"reason", std::string{reason}}});
    }
    for (const absl::StatusCode code : kCodes) {
      if (IsRejection(code)) rejections.Add({{"reason", absl::StatusCodeToString(code)}});
    }
  }

  prometheus::Histogram& Stage(const char* name) { return stages.Add({{"stage", name}}, Buckets()); }

  static void Observe(prometheus::Histogram& stage, double ms) { stage.Observe(ms / 1e3); }

  static void Record(std::monostate /*nothing*/) {}

  void Record(const ComputationFacts& facts) {
    triangles.Increment(static_cast<double>(facts.triangles));
    voxels.Increment(static_cast<double>(facts.voxels));
    if (facts.decode_ms > 0) Observe(decode, facts.decode_ms);
    if (facts.voxelize_ms <= 0) return;
    Observe(voxelize, facts.voxelize_ms);
    Observe(stream, facts.stream_ms);
  }

  void Record(const PixelizationFacts& facts) {
    pixels.Increment(static_cast<double>(facts.pixels));
    if (facts.pixelize_ms > 0) Observe(pixelize, facts.pixelize_ms);
  }
};

Metrics::Metrics() : families_(std::make_unique<Families>()) {
  AddGauge("latvox_build_info", "1, always; what runs.", [] { return 1; },
           {{"version", LATVOX_VERSION}, {"simd", std::string{SimdInUse()}}});
  AddGauge("process_start_time_seconds", "When the process started, since 1970-01-01 UTC.",
           [start = StartTimeSeconds()] { return start; });
  AddGauge("process_resident_memory_bytes", "Resident memory.", ResidentMemoryBytes);
  AddCounter("process_cpu_seconds_total", "Processor time, user and system.", CpuSeconds);
  AddGauge("process_threads", "Threads.", Threads);
  AddGauge("process_open_fds", "Open file descriptors.", OpenFiles);
  AddGauge("process_max_fds", "Most file descriptors that may be open.", MaxOpenFiles);
}

Metrics::~Metrics() = default;

void Metrics::Record(const RequestRecord& record) {
  const absl::StatusCode code = CodeOnWire(record.status);
  const MethodMetrics& of_method = families_->methods.at(record.origin.method);
  of_method.requests.at(code)->Increment();
  if (IsRejection(code)) families_->rejections.Add({{"reason", ReasonOf(record.status)}}).Increment();
  of_method.received->Increment(static_cast<double>(record.bytes_in));
  of_method.sent->Increment(static_cast<double>(record.bytes_out));
  if (record.status.ok()) of_method.durations->Observe(record.total_ms / 1e3);
  if (record.upload_ms) Families::Observe(families_->upload, *record.upload_ms);
  if (record.queue_ms) Families::Observe(families_->queue, *record.queue_ms);
  std::visit([&](const auto& facts) { families_->Record(facts); }, record.work);
}

void Metrics::AddGauge(const std::string& name, const std::string& help, Read read, const Labels& labels) {
  families_->everything->readings.Add(MetricType::Gauge, name, help, std::move(read), labels);
}

void Metrics::AddCounter(const std::string& name, const std::string& help, Read read, const Labels& labels) {
  families_->everything->readings.Add(MetricType::Counter, name, help, std::move(read), labels);
}

std::shared_ptr<prometheus::Collectable> Metrics::collectable() const { return families_->everything; }

std::string Metrics::Text() const { return prometheus::TextSerializer().Serialize(collectable()->Collect()); }

}  // namespace latvox
