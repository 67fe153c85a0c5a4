#include "tests/bench/print.h"

#include <nlohmann/json.hpp>

#include "absl/strings/str_format.h"

namespace latvox {
namespace {

double Least(const Measurement& m) { return m.milliseconds.front(); }
double Median(const std::vector<double>& ascending) { return ascending[ascending.size() / 2]; }
double NsPerTriangle(const Measurement& m) { return Least(m) * 1e6 / static_cast<double>(m.triangles); }
double MvoxelsPerS(const Measurement& m) { return static_cast<double>(m.voxels) / Least(m) / 1e3; }

template <class T>
nlohmann::ordered_json OrNull(const std::optional<T>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
}

}  // namespace

std::string ToText(const Measurement& m) {
  std::string out = absl::StrFormat(
      "%d voxels  %.2f ms min  %.2f ms median  %.1f ns/triangle  %.1f Mvoxels/s  %.0f MB peak  %s", m.voxels, Least(m),
      Median(m.milliseconds), NsPerTriangle(m), MvoxelsPerS(m), static_cast<double>(m.peak_rss_bytes) / 1e6, m.simd);
  if (m.job_peak_bytes) {
    absl::StrAppendFormat(&out, "  %.1f bytes/triangle beyond the mesh",
                          static_cast<double>(*m.job_peak_bytes) / static_cast<double>(m.triangles));
  }
  if (m.first_brick_milliseconds)
    absl::StrAppendFormat(&out, "  %.2f ms to the first brick", *m.first_brick_milliseconds);
  if (m.cancel_milliseconds) absl::StrAppendFormat(&out, "  %.2f ms to cancel", *m.cancel_milliseconds);
  return out;
}

std::string ToJson(const Arguments& arguments, const Measurement& m) {
  const nlohmann::ordered_json out{{"voxels", m.voxels},
                                   {"ms_min", Least(m)},
                                   {"ms_median", Median(m.milliseconds)},
                                   {"ms_processor", Median(m.processor_milliseconds)},
                                   {"ns_per_triangle", NsPerTriangle(m)},
                                   {"mvoxels_per_s", MvoxelsPerS(m)},
                                   {"peak_rss_bytes", m.peak_rss_bytes},
                                   {"threads", arguments.threads},
                                   {"simd", m.simd},
                                   {"digest", m.digest},
                                   {"triangles", m.triangles},
                                   {"ms", m.milliseconds},
                                   {"ms_read", m.read_milliseconds},
                                   {"ms_first_brick", OrNull(m.first_brick_milliseconds)},
                                   {"ms_cancel", OrNull(m.cancel_milliseconds)},
                                   {"job_peak_bytes", OrNull(m.job_peak_bytes)}};
  return out.dump();
}

}  // namespace latvox
