// A band, on a given lattice.
#ifndef LATVOX_CORE_BAND_PLAN_H_
#define LATVOX_CORE_BAND_PLAN_H_

#include "absl/status/statusor.h"
#include "core/band/metric.h"
#include "core/base/vec.h"
#include "core/lattice/lattice.h"
#include "core/request/band.h"

namespace latvox {

struct BandPlan {
  Metric metric;
  double width;    // world units
  __int128 limit;  // the square of the width, as of Inner: larger by up to 2^-45 of it, and by the rounding of g
  // The distance along each lattice axis within which the band's lattice points lie from the surface: in units, and in
  // voxels, rounded up.
  Vec3i margin, reach;
};

// The most voxels of a plan's reach. Room for rounding takes a margin of kMaxBandReach beyond it.
inline constexpr int32_t kMostPlannedReach = kMaxBandReach + 1;

// Returns the distance along each lattice axis, in units, within which all points within a width (world units) lie.
// Errors: INVALID_ARGUMENT if that is over kMaxBandReach voxels.
absl::StatusOr<Vec3i> MarginOf(double width, const Lattice& lattice);

// Returns such a margin in voxels, rounded up.
inline Vec3i ReachOf(const Vec3i& margin) {
  return Shifted(margin + Vec3i{1, 1, 1} * (kLatticeUnit - 1), kSubvoxelBits);
}

// A width in voxel sizes. Below it, the limit would be too coarse for values without rounding error.
inline constexpr double kLeastBandSizes = 0x1p-13;

// Errors: INVALID_ARGUMENT if the width is not above 0 and normal in single precision, is below kLeastBandSizes, or
// reaches over kMaxBandReach; and those of MakeMetric.
absl::StatusOr<BandPlan> MakeBandPlan(const Band& band, const Lattice& lattice);

}  // namespace latvox

#endif  // LATVOX_CORE_BAND_PLAN_H_
