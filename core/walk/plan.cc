#include "core/walk/plan.h"

#include <cmath>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "core/base/status_payload.h"
#include "core/snap/snap.h"

namespace latvox {
namespace {

double SquareTo(const Grid& grid, const Vec3i& ijk, const Vec3d& world) {
  const Vec3d d = Apply(grid.lattice.basis(), ToDouble(ijk)) + grid.origin - world;
  return Dot(d, d);
}

}  // namespace

// A point has no nearer neighbor iff its cell holds the position, because the neighbors' bisectors bound the cell. The
// square falls with each step, so the way ends.
Vec3i NearestPoint(const Grid& grid, const Vec3d& world) {
  const Vec3d at = Apply(grid.lattice.inverse(), world - grid.origin);
  constexpr double kFar = int64_t{1} << (kPositionBits + 1);
  Vec3i ijk;
  for (size_t m = 0; m < 3; ++m) {
    if (!(std::abs(at[m]) < kFar)) return Vec3i{1, 1, 1} * static_cast<int32_t>(-kFar);
    ijk[m] = static_cast<int32_t>(std::nearbyint(at[m]));
  }
  double least = SquareTo(grid, ijk, world);
  for (bool moved = true; std::exchange(moved, false);) {
    const Vec3i from = ijk;
    for (const Neighbor<3>& neighbor : grid.lattice.neighbors()) {
      const Vec3i other = from + neighbor.w;
      const double square = SquareTo(grid, other, world);
      if (square > least || (square == least && !(other < ijk))) continue;
      least = square;
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
  if (start) plan.start = NearestPoint(grid, *start);
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
