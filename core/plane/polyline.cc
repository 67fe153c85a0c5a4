#include "core/plane/polyline.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "absl/strings/str_format.h"
#include "core/snap/range_check.h"

namespace latvox {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr PlaneBounds EmptyBounds() { return {{kInfinity, kInfinity}, {-kInfinity, -kInfinity}}; }

void Extend(PlaneBounds& bounds, const Vec2d& p) {
  for (size_t m = 0; m < 2; ++m) {
    bounds.min[m] = std::min(bounds.min[m], p[m]);
    bounds.max[m] = std::max(bounds.max[m], p[m]);
  }
}

// The unrounded lattice coordinates of p. One fixed expression: the result depends on its rounding.
Vec2d ToLattice(const PlaneLattice& lattice, const Vec2d& origin, const Vec2d& p) {
  const Mat2d& inverse = lattice.inverse();
  const Vec2d d{p[0] - origin[0], p[1] - origin[1]};
  Vec2d v;
  for (size_t m = 0; m < 2; ++m) v[m] = inverse[0][m] * d[0] + inverse[1][m] * d[1];
  return v;
}

constexpr RangeWords kWords{"pixel_size", "the polylines", "the polylines extend", "pixels"};

}  // namespace

double PlaneBounds::LongestSide() const { return std::max(max[0] - min[0], max[1] - min[1]); }

absl::Status CheckPolylines(const std::vector<Polyline>& polylines) {
  if (polylines.empty()) return absl::InvalidArgumentError("polylines: there are none");
  for (size_t n = 0; n < polylines.size(); ++n) {
    const auto& points = polylines[n].points;
    if (points.empty()) return absl::InvalidArgumentError(absl::StrFormat("polylines: polyline %d has no points", n));
    for (size_t p = 0; p < points.size(); ++p) {
      if (std::isfinite(points[p][0]) && std::isfinite(points[p][1])) continue;
      return absl::InvalidArgumentError(absl::StrFormat("polylines: point %d of polyline %d is not finite", p, n));
    }
  }
  return absl::OkStatus();
}

PlaneBounds BoundsOf(const std::vector<Polyline>& polylines) {
  PlaneBounds bounds = EmptyBounds();
  for (const Polyline& polyline : polylines) {
    for (const Vec2d& p : polyline.points) Extend(bounds, p);
  }
  return bounds;
}

absl::StatusOr<SnappedPolylines> Snap(const std::vector<Polyline>& polylines, const PlaneLattice& lattice,
                                      const Vec2d& origin) {
  PlaneBounds range = EmptyBounds();
  for (const Polyline& polyline : polylines) {
    for (const Vec2d& p : polyline.points) {
      Vec2d v = ToLattice(lattice, origin, p);
      for (double& x : v) {
        if (std::isnan(x)) x = kInfinity;  // overflowed on the way; NaN would not widen the range
      }
      Extend(range, v);
    }
  }
  if (auto status = CheckRange(range.min, range.max, lattice.pixel_size(), kWords); !status.ok()) return status;

  SnappedPolylines snapped;
  for (size_t m = 0; m < 2; ++m) {
    // One unit below, since rounding may move the lowest point that far.
    snapped.base_ij[m] = static_cast<int32_t>(std::floor(range.min[m] - 1.0 / kLatticeUnit)) & ~1;
  }
  const auto snap = [&](const Vec2d& p) {
    const Vec2d v = ToLattice(lattice, origin, p);
    Vec2i v_lat;
    for (size_t m = 0; m < 2; ++m) {
      v_lat[m] = static_cast<int32_t>(static_cast<int64_t>(std::nearbyint(v[m] * kLatticeUnit)) -
                                      int64_t{snapped.base_ij[m]} * kLatticeUnit);
    }
    return v_lat;
  };
  for (const Polyline& polyline : polylines) {
    const Vec2i first = snap(polyline.points.front());
    Vec2i last = first;
    for (size_t n = 1; n < polyline.points.size(); ++n) {
      const Vec2i next = snap(polyline.points[n]);
      snapped.segments.push_back({last, next});
      last = next;
    }
    if (polyline.points.size() == 1 || polyline.closed) snapped.segments.push_back({last, first});
  }
  return snapped;
}

}  // namespace latvox
