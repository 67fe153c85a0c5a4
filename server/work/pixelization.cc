#include "server/work/pixelization.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <utility>
#include <vector>

#include "core/plane/pixelize.h"
#include "core/plane/polyline.h"
#include "server/base/errors.h"
#include "server/base/exceptions.h"
#include "server/base/milliseconds.h"
#include "server/wire/plane_convert.h"

namespace latvox {
namespace {

// The memory of a job, in bytes, twice as much as measured. A point or polyline counts for the request, the converted
// drawing and the segments, snapped twice. A crossing counts for the growing lists, and then for the incidences.
constexpr uint64_t kBytesPerPoint = 128, kBytesPerPolyline = 256, kBytesPerCrossing = 64;

absl::Status CheckCancelled(StopSignal stop) {
  return stop.Stopped() ? absl::CancelledError("the request was cancelled") : absl::OkStatus();
}

// An upper estimate: along a direction, a segment meets at most one lattice line more than its length has spacings.
uint64_t EstimateCrossings(const std::vector<Segment>& segments, const std::vector<PlaneFrame>& frames) {
  uint64_t crossings = 0;
  for (const Segment& segment : segments) {
    const Vec2l along{int64_t{segment.b_lat[0]} - segment.a_lat[0], int64_t{segment.b_lat[1]} - segment.a_lat[1]};
    for (const PlaneFrame& frame : frames) {
      const int64_t across = std::abs(Dot(frame.r[0], along));
      if (across > 0) crossings += static_cast<uint64_t>(across / kLatticeUnit) + 1;
    }
  }
  return crossings;
}

// Checks crossings against their limit, and their memory against the budget, before it is used.
absl::Status Admit(const PlaneJobSpec& spec, const PlaneGrid& grid, const Limits& limits, MemoryReservation& memory) {
  const auto snapped = Snap(spec.polylines, grid.lattice, grid.origin);
  if (!snapped.ok()) return WithCauseOfCore(snapped.status(), spec.fields);
  const uint64_t crossings = EstimateCrossings(snapped->segments, grid.lattice.frames(spec.options.separability));
  if (crossings > limits.max_crossings()) return LimitExceeded("crossings", crossings, limits.max_crossings());
  return memory.Grow(memory.bytes() + crossings * kBytesPerCrossing);
}

absl::StatusOr<v1::PixelizeResponse> Answer(const PlaneJobSpec& spec, const Limits& limits, MemoryReservation& memory,
                                            StopSignal stop, PixelizationFacts& facts) {
  if (absl::Status status = CheckPolylines(spec.polylines); !status.ok()) return WithCauseOfCore(status);
  const auto grid = ResolvePlaneGrid(spec.lattice, spec.sampling, spec.origin, BoundsOf(spec.polylines));
  if (!grid.ok()) return WithCauseOfCore(grid.status(), spec.fields);
  if (absl::Status status = Admit(spec, *grid, limits, memory); !status.ok()) return status;
  if (absl::Status status = CheckCancelled(stop); !status.ok()) return status;
  const auto result = Pixelize(spec.polylines, *grid, spec.options, stop);
  if (!result.ok()) return WithCauseOfCore(result.status(), spec.fields);
  facts.pixels = result->pixels.size();
  if (facts.pixels > limits.max_pixels()) return LimitExceeded("pixels", facts.pixels, limits.max_pixels());
  if (absl::Status status = CheckCancelled(stop); !status.ok()) return status;
  return PixelsToProto(spec, *grid, *result);
}

}  // namespace

// Judges by the length of all segments in pixels, at some 0.5 us each.
bool LastsLong(const v1::PixelizeRequest& request) {
  constexpr double kMostPixels = 1e5;
  std::array<double, 2> low{HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL};
  double length = 0;
  for (const v1::Polyline& polyline : request.polylines()) {
    for (int n = 0; n < polyline.xy_size(); ++n) {
      const auto axis = static_cast<size_t>(n % 2);
      low[axis] = std::min(low[axis], polyline.xy(n));
      high[axis] = std::max(high[axis], polyline.xy(n));
      if (n >= 2) length += std::abs(polyline.xy(n) - polyline.xy(n - 2));
    }
  }
  const double side = std::max(high[0] - low[0], high[1] - low[1]);
  switch (request.sampling_case()) {
    case v1::PixelizeRequest::kResolution:
      return length * request.resolution() > kMostPixels * side;
    case v1::PixelizeRequest::kPixelSize:
      return length > kMostPixels * request.pixel_size();
    case v1::PixelizeRequest::SAMPLING_NOT_SET:
      break;
  }
  return true;
}

absl::StatusOr<v1::PixelizeResponse> PixelizePolylines(const v1::PixelizeRequest& request, const Limits& limits,
                                                       MemoryReservation& memory, StopSignal stop,
                                                       PixelizationFacts& facts) {
  const auto began = std::chrono::steady_clock::now();
  auto response = WithoutExceptions([&]() -> absl::StatusOr<v1::PixelizeResponse> {
    facts.points = CountPoints(request);
    const auto polylines = static_cast<uint64_t>(request.polylines_size());
    if (absl::Status status = memory.Grow(facts.points * kBytesPerPoint + polylines * kBytesPerPolyline); !status.ok())
      return status;
    const auto spec = PlaneJobSpecFromProto(request, limits);
    if (!spec.ok()) return spec.status();
    facts.lattice = std::string{spec->lattice.name()};
    facts.separability = spec->options.separability;
    return Answer(*spec, limits, memory, stop, facts);
  });
  facts.pixelize_ms = MillisecondsSince(began);
  if (response.ok()) response->set_pixelize_ms(facts.pixelize_ms);
  return response;
}

}  // namespace latvox
