#include "core/scan/line_scan.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <utility>

namespace latvox {
namespace {

using crossing_internal::Span;
using Corners = std::array<const Vec<int64_t, 3>*, 3>;

// Bounds of the forms p[0] and p[1], given at the corners v, over the part of the triangle between the two planes of
// `near` on each axis. They are rounded outwards, and empty if there is no such part on some axis.
std::array<Span, 2> BoundsWithin(const NearBox& near, const Corners& v,
                                 const std::array<std::array<int64_t, 3>, 2>& p) {
  std::array<Span, 2> bounds;
  for (size_t c = 0; c < 2; ++c) {
    const auto [least, most] = std::minmax({p[c][0], p[c][1], p[c][2]});
    bounds[c] = {least, most};
  }
  for (size_t m = 0; m < 3; ++m) {
    constexpr double kFar = int64_t{1} << 60;
    std::array<double, 2> least{kFar, kFar}, most{-kFar, -kFar};
    // The point at the fraction t of the way from corner n to the next.
    const auto add = [&](size_t n, double t) {
      for (size_t c = 0; c < 2; ++c) {
        const auto from = static_cast<double>(p[c][n]), to = static_cast<double>(p[c][(n + 1) % 3]);
        const double at = from + t * (to - from);
        least[c] = std::min(least[c], at);
        most[c] = std::max(most[c], at);
      }
    };
    for (size_t n = 0; n < 3; ++n) {
      const int64_t z = (*v[n])[m], next = (*v[(n + 1) % 3])[m];
      if (near.min[m] <= z && z <= near.max[m]) add(n, 0);
      for (const int64_t plane : {near.min[m], near.max[m]}) {
        if ((z < plane) != (next < plane)) add(n, static_cast<double>(plane - z) / static_cast<double>(next - z));
      }
    }
    for (size_t c = 0; c < 2; ++c) {
      bounds[c].first = std::max(bounds[c].first, static_cast<int64_t>(std::floor(least[c])) - 1);
      bounds[c].last = std::min(bounds[c].last, static_cast<int64_t>(std::ceil(most[c])) + 1);
    }
  }
  return bounds;
}

// Bounds of E' of edge n over all lines.
Span EdgeBounds(const LineScan<int64_t>& lines, size_t n) {
  const int64_t over_a = lines.edge_a[n] * (lines.width - 1), over_b = lines.edge_b[n] * (lines.height - 1);
  return {lines.edge[n] + std::min<int64_t>(over_a, 0) + std::min<int64_t>(over_b, 0),
          lines.edge[n] + std::max<int64_t>(over_a, 0) + std::max<int64_t>(over_b, 0)};
}

// The sum of two remainders must fit 32 bits. And above this, rounded scans may take along / 2 for `half`.
constexpr int64_t kExactAlong = 1 << 30;

// The largest |entry| of the directions on each axis.
Vec3i ExtentOf(const std::vector<ScanFrame>& frames) {
  Vec3i extent{};
  for (const ScanFrame& scan : frames) {
    for (size_t m = 0; m < 3; ++m) extent[m] = std::max(extent[m], std::abs(scan.frame.q[m]));
  }
  return extent;
}

// The extent of a cell along a form, in lattice units, rounded up.
int32_t ExtentOf(const CellSegments& cell, const Vec3i& form) {
  int32_t sum = 0;
  for (const Vec3i& step : cell.steps) sum += std::abs(Dot(form, step));
  return sum * (kLatticeUnit / 2) / cell.parts + 1;
}

// A voxel's line may have its first voxel one step farther.
Vec3i ReachOf(const CellSegments& cell, const std::vector<ScanFrame>& frames) {
  Vec3i reach = ExtentOf(frames) * kLatticeUnit;
  for (size_t m = 0; m < 3; ++m) {
    Vec3i axis{};
    axis[m] = 1;
    reach[m] += ExtentOf(cell, axis);
  }
  return reach;
}

}  // namespace

NearBox::NearBox(const std::vector<ScanFrame>& frames, const IndexBox& box)
    : NearBox(ExtentOf(frames) * (kLatticeUnit / 2), box) {}  // the nearer half of a link counts

NearBox::NearBox(const Vec3i& reach, const IndexBox& box)
    : min(box.min * kLatticeUnit - reach), max((box.max - Vec3i{1, 1, 1}) * kLatticeUnit + reach) {}

int32_t NarrowExtent(const std::vector<ScanFrame>& frames) {
  int32_t most = 1;
  for (const ScanFrame& scan : frames) {
    for (const Vec3i& u : scan.frame.u) most = std::max(most, std::abs(u[0]) + std::abs(u[1]) + std::abs(u[2]));
  }
  return std::min(1 << 14, static_cast<int32_t>(std::sqrt(((1 << 30) - 1) / most)));
}

bool MakeLineScan(const OrientedTriangle& triangle, const ScanFrame& scan, const IndexBox& box, const NearBox& near,
                  LineScan<int64_t>& out) {
  using crossing_internal::ProjectedEdge;
  using crossing_internal::Wide;
  constexpr int64_t kHalf = kLatticeUnit / 2;
  const Frame& frame = scan.frame;
  const int64_t up = Dot(triangle.normal, frame.q);
  // Counter-clockwise in the projection: the normal must point along q.
  const bool flip = up < 0;
  const int64_t along = flip ? -up : up;
  const Corners v{&triangle.v[0], &triangle.v[flip ? 2 : 1], &triangle.v[flip ? 1 : 2]};
  std::array<int64_t, 3> x, y;
  for (size_t n = 0; n < 3; ++n) {
    x[n] = Dot(frame.r[0], *v[n]);
    y[n] = Dot(frame.r[1], *v[n]);
  }
  const auto [x_part, y_part] = BoundsWithin(near, v, {x, y});
  const auto lines = [&](const Span& part, int64_t reach, const Vec3i& row) {
    const Span all = crossing_internal::RangeOver(box, row);
    return Span{std::max((part.first - reach * kHalf + kLatticeUnit - 1) >> kSubvoxelBits, all.first),
                std::min((part.last + reach * kHalf) >> kSubvoxelBits, all.last)};
  };
  const Span a = lines(x_part, scan.reach_a, frame.r[0]), b = lines(y_part, scan.reach_b, frame.r[1]);
  if (a.first > a.last || b.first > b.last) return false;
  out.a = a.first;
  out.b = b.first;
  out.width = static_cast<int32_t>(a.last - a.first + 1);
  out.height = static_cast<int32_t>(b.last - b.first + 1);

  const int64_t from_a = a.first * kLatticeUnit, from_b = b.first * kLatticeUnit;
  for (size_t n = 0; n < 3; ++n) {
    const size_t next = (n + 1) % 3;
    const ProjectedEdge edge(frame, x[n], y[n], x[next], y[next]);
    int64_t rim = 0;
    for (const auto& q : scan.hull) rim = std::max(rim, std::abs(edge.dx * q[1] - edge.dy * q[0]));
    const int64_t value = edge.dx * (from_b - edge.y) - edge.dy * (from_a - edge.x) + edge.tie - 1;
    out.edge[n] = value >> kSubvoxelBits;
    out.edge_a[n] = -edge.dy;
    out.edge_b[n] = edge.dx;
    out.rim[n] = (rim + 1) / 2;
    if (EdgeBounds(out, n).last < -out.rim[n]) return false;
  }

  const int64_t sign = flip ? -1 : 1;
  const int64_t n_a = sign * Dot(triangle.normal, frame.u[0]), n_b = sign * Dot(triangle.normal, frame.u[1]);
  const int64_t z0 = Dot(frame.r[2], *v[0]);
  const Wide numerator =
      Wide{z0 + kHalf} * along - Wide{n_a} * (from_a - x[0]) - Wide{n_b} * (from_b - y[0]) - (flip ? 1 : 0);
  const Wide level = numerator >> kSubvoxelBits;
  const bool low_part = (static_cast<uint64_t>(numerator) & (kLatticeUnit - 1)) < kHalf;
  const Wide depth = level / along - (level % along < 0 ? 1 : 0);
  out.along = along;
  out.level_a = -n_a;
  out.level_b = -n_b;
  out.depth = static_cast<int32_t>(depth);
  out.remainder = static_cast<int64_t>(level - depth * along);
  out.half = (along + (low_part ? 1 : 0)) / 2;
  out.doubt = 0;
  return true;
}

LinesInBox::LinesInBox(const LineScan<int64_t>& lines, const Frame& frame, const Vec3i& size) : last_(lines.width - 1) {
  for (size_t n = 0; n < 3; ++n) {
    if (EdgeBounds(lines, n).first >= -lines.rim[n]) continue;
    Add(static_cast<double>(lines.edge[n] + lines.rim[n]), static_cast<double>(lines.edge_a[n]),
        static_cast<double>(lines.edge_b[n]));
  }
  // Coordinates are linear over the lines, except for the depth's rounding down.
  const auto per_line = [&](int64_t level) { return static_cast<double>(level) / static_cast<double>(lines.along); };
  const double slope_a = per_line(lines.level_a), slope_b = per_line(lines.level_b);
  for (size_t m = 0; m < 3; ++m) {
    const int32_t q = frame.q[m], u0 = frame.u[0][m], u1 = frame.u[1][m];
    const auto first = static_cast<double>(lines.a * u0 + lines.b * u1 + int64_t{lines.depth} * q);
    const double per_a = u0 + slope_a * q, per_b = u1 + slope_b * q;
    const double over_a = per_a * (lines.width - 1), over_b = per_b * (lines.height - 1);
    const double slack = q == 0 ? 0 : std::abs(q) + 0.25;  // a quarter for the doubles
    const double top = size[m] - 1;
    if (first + std::min(over_a, 0.0) + std::min(over_b, 0.0) - slack < 0) {
      astride_ |= 1U << m;
      Add(first + slack, per_a, per_b);
    }
    if (first + std::max(over_a, 0.0) + std::max(over_b, 0.0) + slack > top) {
      astride_ |= 1U << m;
      Add(top - first + slack, -per_a, -per_b);
    }
  }
}

void LinesInBox::Add(double at, double per_a, double per_b) {
  bounds_[count_++] = {at, per_a == 0 ? 0 : -1 / per_a, per_b};
}

Span LinesInBox::Row(int32_t b, int32_t high) const {
  double first = 0, last = last_;
  for (size_t n = 0; n < count_; ++n) {
    const auto& [at, a_per, per_b] = bounds_[n];
    const double value = at + per_b * b + std::max(per_b * (high - 1), 0.0);
    if (a_per < 0) {
      first = std::max(first, value * a_per);
    } else if (a_per > 0) {
      last = std::min(last, value * a_per);
    } else if (value < 0) {
      return {0, -1};
    }
  }
  constexpr double kSlack = 1.0 / 64;  // in lines, for the doubles
  // To truncate is to round down: both are at least 0.
  return {static_cast<int64_t>(std::min(first, last_ + 1) + 1 - kSlack),
          static_cast<int64_t>(std::max(last, -1.0) + 1 + kSlack) - 1};
}

bool Narrow(const LineScan<int64_t>& lines, bool rounded, LineScan<int32_t>& out) {
  const auto fits = [](int64_t i) { return i == static_cast<int32_t>(i); };
  out.a = lines.a;
  out.b = lines.b;
  out.width = lines.width;
  out.height = lines.height;
  for (size_t n = 0; n < 3; ++n) {
    const auto [least, most] = EdgeBounds(lines, n);
    const bool matters = least < 0;
    if (matters && !(fits(least) && fits(most + lines.rim[n]) && fits(lines.rim[n]))) return false;
    out.edge[n] = matters ? static_cast<int32_t>(lines.edge[n]) : 0;
    out.edge_a[n] = matters ? static_cast<int32_t>(lines.edge_a[n]) : 0;
    out.edge_b[n] = matters ? static_cast<int32_t>(lines.edge_b[n]) : 0;
    out.rim[n] = matters ? static_cast<int32_t>(lines.rim[n]) : 0;
  }

  out.depth = lines.depth;
  if (rounded) {
    if (lines.along <= kExactAlong) return false;
    constexpr int32_t kAlong = 1 << kScaledBits;
    const double scale = kAlong / static_cast<double>(lines.along);
    const auto scaled = [&](int64_t i) { return static_cast<int64_t>(static_cast<double>(i) * scale); };
    const int64_t level_a = scaled(lines.level_a), level_b = scaled(lines.level_b);
    if (!fits(level_a) || !fits(level_b)) return false;
    out.along = kAlong;
    out.level_a = static_cast<int32_t>(level_a);
    out.level_b = static_cast<int32_t>(level_b);
    out.remainder = static_cast<int32_t>(std::min<int64_t>(scaled(lines.remainder), kAlong - 1));
    out.half = kAlong / 2;
    // Less than one for the first line and for each step, a quarter for half, and some for the rounding of doubles.
    out.doubt = lines.width + lines.height;
    return true;
  }
  const int64_t common = std::gcd(std::gcd(lines.along, lines.level_a), lines.level_b);
  const int64_t along = lines.along / common, level_a = lines.level_a / common, level_b = lines.level_b / common;
  if (along > kExactAlong || !fits(level_a) || !fits(level_b)) return false;
  const int64_t part = lines.remainder % common;  // the same on all lines
  out.along = static_cast<int32_t>(along);
  out.level_a = static_cast<int32_t>(level_a);
  out.level_b = static_cast<int32_t>(level_b);
  out.remainder = static_cast<int32_t>(lines.remainder / common);
  out.half = static_cast<int32_t>(crossing_internal::CeilDiv(lines.half - part, common));
  out.doubt = 0;
  return true;
}

FrameTable::FrameTable(const std::vector<ScanFrame>& frames, const IndexBox& box, const NearBox& near_box)
    : size(frames.size()), near(near_box) {
  for (size_t n = 0; n < size; ++n) {
    const Frame& frame = frames[n].frame;
    for (size_t m = 0; m < 3; ++m) {
      q[m].of[n] = frame.q[m];
      reach = std::max(reach, std::abs(frame.q[m]));
      for (size_t row = 0; row < 3; ++row) r[row][m].of[n] = frame.r[row][m];
      for (size_t column = 0; column < 2; ++column) u[column][m].of[n] = frame.u[column][m];
    }
    for (size_t axis = 0; axis < 2; ++axis) {
      const auto lines = crossing_internal::RangeOver(box, frame.r[axis]);
      first[axis].of[n] = static_cast<int32_t>(lines.first);
      last[axis].of[n] = static_cast<int32_t>(lines.last);
    }
  }
}

FrameTable::FrameTable(const std::vector<ScanFrame>& frames, const IndexBox& box)
    : FrameTable(frames, box, NearBox(frames, box)) {
  for (size_t n = 0; n < size; ++n) {
    for (size_t axis = 0; axis < 2; ++axis) {
      rim[axis].of[n] = static_cast<int32_t>(axis == 0 ? frames[n].reach_a : frames[n].reach_b) * kLatticeUnit / 2;
    }
    hull_size = std::max(hull_size, frames[n].hull.size());
    for (size_t h = 0; h < frames[n].hull.size(); ++h) {
      for (size_t axis = 0; axis < 2; ++axis) hull[h][axis].of[n] = static_cast<int32_t>(frames[n].hull[h][axis]);
    }
  }
}

FrameTable::FrameTable(const std::vector<ScanFrame>& frames, const IndexBox& box, CellSegments segments)
    : FrameTable(frames, box, NearBox(ReachOf(segments, frames), box)) {
  cell = std::move(segments);
  hull_size = cell.steps.size();
  for (size_t n = 0; n < size; ++n) {
    for (size_t axis = 0; axis < 2; ++axis) {
      const Vec3i& form = frames[n].frame.r[axis];
      rim[axis].of[n] = ExtentOf(cell, form);
      for (size_t h = 0; h < hull_size; ++h) hull[h][axis].of[n] = Dot(form, cell.steps[h]);
    }
  }
}

}  // namespace latvox
