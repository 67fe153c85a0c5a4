// What a band is on a lattice.
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
  double unit;     // world length of a unit of the metric
  __int128 limit;  // the square of the width, as of Inner: larger by up to 2^-45 of it, and by what g is rounded by
  // How far along each lattice axis the lattice points of the band may lie from the surface: in units, and in voxels,
  // rounded up.
  Vec3i margin, reach;
  bool is_signed;
};

// How far along each lattice axis what lies within a width (world units) may be, in units. Errors: INVALID_ARGUMENT if
// that is over kMaxBandReach voxels.
absl::StatusOr<Vec3i> MarginOf(double width, const Lattice& lattice);

// Such a margin in voxels, rounded up.
inline Vec3i ReachOf(const Vec3i& margin) {
  return Shifted(margin + Vec3i{1, 1, 1} * (kLatticeUnit - 1), kSubvoxelBits);
}

// Widths in voxel sizes: for less, the limit would be too coarse for values that are as good as exact.
inline constexpr double kLeastBandSizes = 0x1p-13;

// Errors: INVALID_ARGUMENT if the width is not above 0 and normal in single precision, is below kLeastBandSizes, or
// reaches over kMaxBandReach; and as MakeMetric.
absl::StatusOr<BandPlan> MakeBandPlan(const Band& band, const Lattice& lattice);

}  // namespace latvox

#endif  // LATVOX_CORE_BAND_PLAN_H_
