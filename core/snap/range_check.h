// Whether lattice coordinates fit the widths of snap.h, in space and in the plane.
#ifndef LATVOX_CORE_SNAP_RANGE_CHECK_H_
#define LATVOX_CORE_SNAP_RANGE_CHECK_H_

#include <cmath>

#include "absl/strings/str_format.h"
#include "core/base/status_payload.h"
#include "core/base/vec.h"
#include "core/snap/snap.h"

namespace latvox {

// The words of the messages.
struct RangeWords {
  const char* size_field;  // "voxel_size"
  const char* shape;       // "the mesh"
  const char* extends;     // "the mesh extends"
  const char* points;      // "voxels"
};

// Checks the closed range min .. max of unrounded lattice coordinates. Errors, with value and limit: RESOURCE_EXHAUSTED
// if it is longer than kMaxExtent; INVALID_ARGUMENT if it reaches beyond 2^kPositionBits. The extent comes first: a
// shape that is too large may also lie too far away, and then no origin would help.
//   size   the voxel or pixel size, for the message
template <size_t D>
absl::Status CheckRange(const Vec<double, D>& min, const Vec<double, D>& max, double size, const RangeWords& words) {
  constexpr char kAxisName[] = "ijk";
  constexpr double kMaxPosition = 1 << kPositionBits;
  for (size_t m = 0; m < D; ++m) {
    const double extent = std::floor(max[m]) - std::floor(min[m]) + 1;
    if (extent > kMaxExtent) {
      return WithValue(absl::ResourceExhaustedError(absl::StrFormat(
                           "%s: at %g %s over %.0f %s on lattice axis %c, the limit is %d", words.size_field, size,
                           words.extends, extent, words.points, kAxisName[m], kMaxExtent)),
                       extent, kMaxExtent);
    }
  }
  for (size_t m = 0; m < D; ++m) {
    for (double x : {min[m], max[m]}) {
      if (std::abs(x) <= kMaxPosition) continue;  // NaN is refused, too
      return WithValue(absl::InvalidArgumentError(
                           absl::StrFormat("origin: it puts %s at lattice coordinate %g on axis %c, the limit is %.0f",
                                           words.shape, x, kAxisName[m], kMaxPosition)),
                       x, kMaxPosition);
    }
  }
  return absl::OkStatus();
}

}  // namespace latvox

#endif  // LATVOX_CORE_SNAP_RANGE_CHECK_H_
