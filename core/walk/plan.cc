#include "core/walk/plan.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/strip.h"
#include "core/base/status_payload.h"
#include "core/snap/snap.h"

namespace latvox {
namespace {

// Returns the square of a length in units near the basis. Squares of other units may all be 0 or infinite.
double SquareOf(Vec3d d, const Lattice& lattice) {
  double longest = 0;
  for (const Vec3d& step : lattice.basis()) {
    for (const double x : step) longest = std::max(longest, std::abs(x));
  }
  for (double& x : d) x = std::scalbn(x, -std::ilogb(longest));
  return Dot(d, d);
}

}  // namespace

Vec3i ReachOf(const WalkPlan& walk) {
  Vec3i reach = walk.steps.reach;
  for (size_t m = 0; walk.close && m < 3; ++m) reach[m] = std::max(reach[m], 2 * walk.close->reach[m]);
  return reach;
}

// A point has no nearer neighbor iff its cell holds the position, because the neighbors' bisectors bound the cell.
// World positions decide between points that are equally near. In their sums with a far origin all points may be
// equally near. So the way keeps to points that are not farther from the origin plus `offset`, and there are few of
// these.
absl::StatusOr<Vec3i> NearestPoint(const Grid& grid, const Vec3d& world, const std::string& field, StopSignal stop) {
  const Vec3d offset = world - grid.origin, at = Apply(grid.lattice.inverse(), offset);
  constexpr double kMaxPosition = 1 << kPositionBits;
  Vec3i ijk;
  for (size_t m = 0; m < 3; ++m) {
    if (!(std::abs(at[m]) <= kMaxPosition)) {  // NaN is refused, too
      return WithValue(absl::InvalidArgumentError(
                           absl::StrFormat("%s: it lies at lattice coordinate %g on axis %c, the limit is %.0f", field,
                                           at[m], "ijk"[m], kMaxPosition)),
                       at[m], kMaxPosition);
    }
    ijk[m] = static_cast<int32_t>(std::nearbyint(at[m]));
  }
  const auto from_offset = [&](const Vec3i& point) {
    return SquareOf(Apply(grid.lattice.basis(), ToDouble(point)) - offset, grid.lattice);
  };
  const auto in_world = [&](const Vec3i& point) {
    return SquareOf(Apply(grid.lattice.basis(), ToDouble(point)) + grid.origin - world, grid.lattice);
  };
  constexpr double kRounding = 1 + 1e-9;
  double least = in_world(ijk), nearest = from_offset(ijk);
  for (bool moved = true; std::exchange(moved, false) && !stop.Stopped();) {
    const Vec3i from = ijk;
    for (const Neighbor<3>& neighbor : grid.lattice.neighbors()) {
      const Vec3i other = from + neighbor.w;
      const double square = in_world(other), other_from_offset = from_offset(other);
      if (other_from_offset > nearest * kRounding) continue;
      if (square > least || (square == least && !(other < ijk))) continue;
      least = square;
      nearest = std::min(nearest, other_from_offset);
      ijk = other;
      moved = true;
    }
  }
  return ijk;
}

absl::StatusOr<WalkPlan> MakeWalkPlan(const WalkSet& walk, const Grid& grid, const std::vector<Frame>& frames,
                                      StopSignal stop) {
  WalkPlan plan{.steps = MakeWalkSteps(frames), .close = std::nullopt, .start = std::nullopt, .grid = grid};
  plan.from_seed = walk.seed.has_value();
  plan.allow_outside = walk.allow_outside;
  plan.with_surface = walk.with_surface;
  const std::optional<Vec3d>& start = walk.seed ? walk.seed : walk.leak_from;
  if (start) {
    const auto nearest = NearestPoint(grid, *start, plan.from_seed ? "connected.seed" : "enclosed.leak_from", stop);
    if (!nearest.ok()) return nearest.status();
    plan.start = *nearest;
  }
  if (walk.close == 0) return plan;
  absl::StatusOr<BandPlan> close = MakeBandPlan({walk.close / 2, false}, grid.lattice);
  if (!close.ok()) {
    absl::string_view why = close.status().message();
    if (!absl::ConsumePrefix(&why, "band: ")) return close.status();
    const std::string field = plan.from_seed ? "connected.close" : "enclosed.close", value = absl::StrCat(walk.close);
    return WithField(absl::InvalidArgumentError(absl::StrCat(field, " ", value, ": of half of it, ", why)), field,
                     value);
  }
  plan.close = *std::move(close);
  plan.ball = std::make_shared<const Ball>(*plan.close, stop);
  return plan;
}

}  // namespace latvox
