#include "core/band/plan.h"

#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_format.h"
#include "core/base/status_payload.h"

namespace latvox {
namespace {

// A point at exactly the width belongs to the band, although doubles are seldom the exact number, and g may be rounded.
// So the square is slightly larger. With |v[m]| <= margin[m], rounding adds at most half of (sum of |v[m]|)^2 to v^T g
// v.
__int128 LimitOf(const Metric& metric, double sizes, const Vec3i& margin) {
  constexpr double kSlack = 1 + 0x1p-46;
  const auto square =
      static_cast<__int128>(std::ceil(std::ldexp(sizes * sizes * metric.one, 2 * kSubvoxelBits) * kSlack));
  const int64_t sum = int64_t{margin[0]} + margin[1] + margin[2];
  return square + (metric.is_exact ? 0 : (sum * sum + 1) / 2);
}

}  // namespace

// A vector no longer than the width has an m-th coordinate of at most the width times the length of row m of V^-1.
absl::StatusOr<Vec3i> MarginOf(double width, const Lattice& lattice) {
  constexpr double kSlack = 1 + 0x1p-20;  // for rounding, including that of the metric
  static_assert(kMaxBandReach * kLatticeUnit * kSlack <= kMostPlannedReach * kLatticeUnit);
  Vec3i margin;
  for (size_t m = 0; m < 3; ++m) {
    double square = 0;
    for (size_t c = 0; c < 3; ++c) square += lattice.inverse()[c][m] * lattice.inverse()[c][m];
    const double voxels = width * std::sqrt(square);
    if (!(voxels <= kMaxBandReach)) {
      return WithValue(absl::InvalidArgumentError(absl::StrFormat(
                           "band: a width of %g reaches over %g voxels on lattice axis %c, the limit is %d", width,
                           voxels, "ijk"[m], kMaxBandReach)),
                       voxels, kMaxBandReach);
    }
    margin[m] = static_cast<int32_t>(std::ceil(voxels * kLatticeUnit * kSlack));
  }
  return margin;
}

absl::StatusOr<BandPlan> MakeBandPlan(const Band& band, const Lattice& lattice) {
  const double width = WidthOf(band, lattice);
  using Float = std::numeric_limits<float>;
  if (!(width >= double{Float::min()} && width <= double{Float::max()})) {
    return WithValue(absl::InvalidArgumentError(absl::StrFormat("band: a width of %g is not within %g and %g", width,
                                                                double{Float::min()}, double{Float::max()})),
                     width, double{width < 1 ? Float::min() : Float::max()});
  }
  const double size = lattice.voxel_size();
  if (width < kLeastBandSizes * size) {
    return WithValue(absl::InvalidArgumentError(absl::StrFormat(
                         "band: a width of %g is below 1/%g of the voxel size %g", width, 1 / kLeastBandSizes, size)),
                     width, kLeastBandSizes * size);
  }
  const absl::StatusOr<Vec3i> margin = MarginOf(width, lattice);
  if (!margin.ok()) return margin.status();
  const absl::StatusOr<Metric> metric = MakeMetric(lattice);
  if (!metric.ok()) return metric.status();
  return BandPlan{*metric, width, LimitOf(*metric, width / size, *margin), *margin, ReachOf(*margin)};
}

}  // namespace latvox
