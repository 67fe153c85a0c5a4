#include "core/attributes/plan.h"

#include <algorithm>
#include <cmath>

#include "core/band/plan.h"
#include "core/snap/snap.h"

namespace latvox {
namespace {

double LengthOf(const Vec3d& v) { return std::sqrt(Dot(v, v)); }

// World units.
double FarthestVoxel(const Lattice& lattice, const std::vector<Frame>& frames, bool supercover) {
  const Mat3d& basis = lattice.basis();
  if (supercover) return LengthOf({LengthOf(basis[0]), LengthOf(basis[1]), LengthOf(basis[2])}) / 2;
  double longest = 0;
  for (const Frame& frame : frames) longest = std::max(longest, LengthOf(Apply(basis, ToDouble(frame.q))));
  return longest / 2;
}

}  // namespace

absl::StatusOr<AttributePlan> MakeAttributePlan(const Lattice& lattice, const std::vector<Frame>& frames,
                                                bool supercover) {
  constexpr double kSlack = 1 + 0x1p-16;  // for rounding, including that of the metric and of a supercover's cell
  const double farthest = FarthestVoxel(lattice, frames, supercover) * kSlack;
  const absl::StatusOr<Vec3i> margin = MarginOf(farthest, lattice);
  if (!margin.ok()) return margin.status();
  const absl::StatusOr<Metric> metric = MakeMetric(lattice);
  if (!metric.ok()) return metric.status();
  const double units = farthest / lattice.voxel_size() * kLatticeUnit;
  return AttributePlan{*metric, units * units, *margin, ReachOf(*margin)};
}

}  // namespace latvox
