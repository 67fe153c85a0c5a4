// Polylines as they arrive, and their one rounding: world coordinates -> fixed-point lattice coordinates.
//
// Frames:
//   _lat   fixed-point lattice coordinates relative to `base_ij`, in units of 1/kLatticeUnit of a pixel (int32)
//   ij     lattice coordinates; ij - base_ij is called local
#ifndef LATVOX_CORE_PLANE_POLYLINE_H_
#define LATVOX_CORE_PLANE_POLYLINE_H_

#include <vector>

#include "absl/status/statusor.h"
#include "core/lattice/lattice.h"
#include "core/snap/snap.h"

namespace latvox {

// One contour. Contours may touch, cross and repeat themselves and each other.
struct Polyline {
  std::vector<Vec2d> points;  // world units
  bool closed = false;        // whether a segment leads from the last point back to the first
};

// World-space box, closed on both sides.
struct PlaneBounds {
  Vec2d min, max;
  // Length of the longer side, world units.
  double LongestSide() const;
};

// INVALID_ARGUMENT, naming the element, if there is no polyline, or one without points, or a point that is not finite.
absl::Status CheckPolylines(const std::vector<Polyline>& polylines);

// Box of all points. Precondition: CheckPolylines(polylines).
PlaneBounds BoundsOf(const std::vector<Polyline>& polylines);

// Ends in fixed-point lattice coordinates. Both ends may be the same point.
struct Segment {
  Vec2i a_lat, b_lat;
};

// Bit widths of absolute values (without sign), with the fixed point of core/snap. Projected by a frame's row;
// positions carry one bit more than differences, for the alignment of base_ij:
inline constexpr int kPlaneProjectedBits = kEdgeBits + 1 + kPlaneStepBits;
// Numerators of depths: the sum of two products of projected coordinates. (Denominators have fewer.)
inline constexpr int kPlaneDepthBits = 2 * kPlaneProjectedBits + 1;
static_assert(kPlaneDepthBits <= 62, "depths must fit int64");
static_assert(kPlaneProjectedBits + kSubvoxelBits <= 61, "twice a remainder of depths must fit int64");

struct SnappedPolylines {
  Vec2i base_ij;                  // even on both axes: parity classes of local pixels are those of pixels
  std::vector<Segment> segments;  // 0 <= coordinate < (kMaxExtent + 2) * kLatticeUnit
};

// Maps p to V^-1 (p - origin), rounded half to even to multiples of 1/kLatticeUnit: no point moves by more than
// kSnapErrorMax in either lattice coordinate. A polyline of one point becomes one segment of length zero.
// Errors: RESOURCE_EXHAUSTED if the extent along an axis exceeds kMaxExtent; INVALID_ARGUMENT if the position exceeds
// 2^kPositionBits.
// Precondition: CheckPolylines(polylines).
absl::StatusOr<SnappedPolylines> Snap(const std::vector<Polyline>& polylines, const PlaneLattice& lattice,
                                      const Vec2d& origin);

}  // namespace latvox

#endif  // LATVOX_CORE_PLANE_POLYLINE_H_
