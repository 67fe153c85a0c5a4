#include "core/plane/pixelize.h"

#include <cmath>
#include <utility>

#include "absl/strings/str_format.h"
#include "core/base/status_payload.h"
#include "core/plane/cover.h"
#include "core/plane/thesis_lines.h"

namespace latvox {
namespace {

absl::Status OutOfRange(const char* field, double value, const char* limit) {
  return absl::InvalidArgumentError(absl::StrFormat("%s: %g is not %s", field, value, limit));
}

absl::Status CheckBruteForceCost(const std::vector<Segment>& segments, const PlaneLattice& lattice, int k) {
  const uint64_t pixels = BruteForceCost(segments, lattice, k);
  if (pixels <= kMaxBruteForcePixels) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrFormat("algorithm: brute force would test %d pixels, the limit is %d", pixels, kMaxBruteForcePixels));
}

// Returns pixels that are not thinned. Precondition: the points are pixels if the algorithm requires that.
std::vector<Vec2i> Digitize(const std::vector<Segment>& segments, const PlaneLattice& lattice,
                            const PixelizeOptions& options, StopSignal stop, std::vector<Vec2i> nearer) {
  switch (options.algorithm) {
    case LineAlgorithm::kBruteForce:
      return BruteForceLines(segments, lattice, options.separability, stop);
    case LineAlgorithm::kIncremental:
      return IncrementalLines(segments, lattice, options.separability, stop);
    case LineAlgorithm::kIbanez:
      return IbanezLines(segments, lattice, options.separability, stop);
    case LineAlgorithm::kCrossing:
      break;
  }
  return nearer;
}

}  // namespace

absl::StatusOr<PlaneGrid> ResolvePlaneGrid(const PlaneLattice& lattice, const PlaneSampling& sampling,
                                           const std::optional<Vec2d>& origin, const PlaneBounds& bounds) {
  std::optional<double> pixel_size = sampling.pixel_size;
  if (pixel_size && !(*pixel_size > 0 && std::isfinite(*pixel_size))) {
    return OutOfRange("pixel_size", *pixel_size, "a finite number above 0");
  }
  if (sampling.resolution) {
    if (pixel_size) return absl::InvalidArgumentError("resolution: not together with pixel_size");
    if (*sampling.resolution < 2 || *sampling.resolution > kMaxPlaneResolution) {
      return OutOfRange("resolution", *sampling.resolution, "within 2 to 65536");
    }
    pixel_size = bounds.LongestSide() / (*sampling.resolution - 1);
    if (!(*pixel_size > 0)) {
      return absl::InvalidArgumentError("resolution: the polylines are a single point; give pixel_size");
    }
    if (!std::isfinite(*pixel_size)) return OutOfRange("resolution", *sampling.resolution, "finite for these bounds");
  }
  if (origin) {
    for (double x : *origin) {
      if (!std::isfinite(x)) return OutOfRange("origin", x, "a finite number");
    }
  }
  auto scaled = pixel_size ? lattice.Scaled(*pixel_size) : lattice;
  if (!scaled.ok()) {
    return WithValue(absl::InvalidArgumentError(
                         absl::StrFormat("pixel_size: at %g, %s", *pixel_size, std::string(scaled.status().message()))),
                     absl::StrFormat("%g", *pixel_size));
  }
  return PlaneGrid{*std::move(scaled), origin.value_or(bounds.min)};
}

absl::StatusOr<PixelizeResult> Pixelize(const std::vector<Polyline>& polylines, const PlaneGrid& grid,
                                        const PixelizeOptions& options, StopSignal stop) {
  const int k = options.separability;
  if (k < 0 || k > 1) return OutOfRange("separability", k, "0 or 1");
  if (auto status = CheckPolylines(polylines); !status.ok()) return status;
  auto snapped = Snap(polylines, grid.lattice, grid.origin);
  if (!snapped.ok()) return snapped.status();
  std::vector<Segment> segments = std::move(snapped->segments);
  if (options.algorithm == LineAlgorithm::kIncremental || options.algorithm == LineAlgorithm::kIbanez) {
    segments = RoundToPixels(segments, grid.lattice);
  }
  if (options.algorithm == LineAlgorithm::kBruteForce) {
    if (auto status = CheckBruteForceCost(segments, grid.lattice, k); !status.ok()) return status;
  }

  PlaneCrossings crossings = FindCrossings(segments, grid.lattice.frames(k), stop);
  PixelizeResult result;
  result.pixels = Digitize(segments, grid.lattice, options, stop, std::move(crossings.nearer));
  if (options.minimal) Thin(crossings.links, result.pixels, stop);
  const PlaneVerdict verdict = Judge(crossings.links, result.pixels, stop);
  if (stop.Stopped()) return absl::CancelledError("pixelization cancelled");
  result.crossed_links = crossings.links.size();
  result.tunnels = verdict.tunnels;
  result.redundant = verdict.redundant;
  for (Vec2i& ij : result.pixels) ij = ij + snapped->base_ij;
  return result;
}

}  // namespace latvox
