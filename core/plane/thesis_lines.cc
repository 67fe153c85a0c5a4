#include "core/plane/thesis_lines.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "core/base/sort.h"
#include "core/plane/crossing2.h"

namespace latvox {
namespace {

using crossing_internal::CeilDiv, crossing_internal::FloorDiv;

// Squares that differ by less than this factor are equal.
constexpr double kTie = 1 + 2 * kSymmetryTolerance;

Vec2l Wide(const Vec2i& v) { return {v[0], v[1]}; }

Vec2i ToPixel(const Vec2i& v_lat) { return {v_lat[0] / kLatticeUnit, v_lat[1] / kLatticeUnit}; }

// The world vector of a difference in lattice coordinates; `unit` of them are a pixel.
Vec2d ToWorld(const PlaneLattice& lattice, const Vec2l& d, double unit) {
  return Apply(lattice.basis(), Vec2d{static_cast<double>(d[0]) / unit, static_cast<double>(d[1]) / unit});
}

// Normal of a segment as a covector in lattice coordinates, first nonzero entry positive; (0, 0) for length zero.
Vec2l NormalOf(const Segment& segment) {
  const Vec2l d = Wide(segment.b_lat) - Wide(segment.a_lat), normal{-d[1], d[0]};
  return FirstNonzeroIsPositive(normal) ? normal : -normal;
}

// If p is not in the cell of z, then a neighbor of z is nearer: the cell is bounded by their bisectors.
Vec2i NearestPixel(const PlaneLattice& lattice, const Vec2i& p_lat) {
  Vec2i z;
  for (size_t m = 0; m < 2; ++m) z[m] = static_cast<int32_t>(FloorDiv(p_lat[m] + kLatticeUnit / 2, kLatticeUnit));
  const auto distance2 = [&](const Vec2i& ij) {
    const Vec2d d = ToWorld(lattice, Wide(ij * kLatticeUnit) - Wide(p_lat), kLatticeUnit);
    return Dot(d, d);
  };
  double least = distance2(z);
  for (bool moved = true; moved;) {
    moved = false;
    for (const auto& neighbor : lattice.neighbors()) {
      const double d2 = distance2(z + neighbor.w);
      if (d2 * kTie >= least) continue;
      least = d2;
      z = z + neighbor.w;
      moved = true;
      break;
    }
  }
  return z;
}

// Largest interface distance of a k-neighbor, world units.
double LargestInterfaceDistance(const PlaneLattice& lattice, int k) {
  double r2 = 0;
  for (const PlaneFrame& frame : lattice.frames(k)) {
    const Vec2d q = ToWorld(lattice, Wide(frame.q), 1);
    r2 = std::max(r2, Dot(q, q) / 4);
  }
  return std::sqrt(r2);
}

struct PixelBox {
  Vec2l min, max;  // both included
};

// Section 4.2's box: a margin of 2 pixels, or what a disc of radius R needs on a skew lattice.
PixelBox BoxAround(const Segment& segment, const PlaneLattice& lattice, double r) {
  PixelBox box;
  for (size_t m = 0; m < 2; ++m) {
    const double row = std::hypot(lattice.inverse()[0][m], lattice.inverse()[1][m]);
    const auto margin = std::max(int64_t{2}, static_cast<int64_t>(std::ceil(r * row)));
    const auto [low, high] = std::minmax({segment.a_lat[m], segment.b_lat[m]});
    box.min[m] = FloorDiv(low, kLatticeUnit) - margin;
    box.max[m] = CeilDiv(high, kLatticeUnit) + margin;
  }
  return box;
}

void BruteForceLine(const Segment& segment, const PlaneLattice& lattice, int k, double r, StopSignal stop,
                    std::vector<Vec2i>& pixels) {
  const Vec2l a = Wide(segment.a_lat), b = Wide(segment.b_lat), normal = NormalOf(segment);
  int64_t twice_t = 0;  // of the integer normal, in units of 1/kLatticeUnit
  for (const PlaneFrame& frame : lattice.frames(k)) {
    twice_t = std::max(twice_t, std::abs(Dot(normal, frame.q)) * kLatticeUnit);
  }
  const Vec2d along = ToWorld(lattice, b - a, kLatticeUnit);
  const double r2 = r * r * kTie, length2 = Dot(along, along);
  const PixelBox box = BoxAround(segment, lattice, r);
  for (int64_t i = box.min[0]; i <= box.max[0] && !stop.Stopped(); ++i) {
    for (int64_t j = box.min[1]; j <= box.max[1]; ++j) {
      const Vec2l z{i * kLatticeUnit, j * kLatticeUnit};
      const Vec2d from_a = ToWorld(lattice, z - a, kLatticeUnit), from_b = ToWorld(lattice, z - b, kLatticeUnit);
      const int64_t twice_d = 2 * Dot(normal, z - a);
      const double foot = Dot(from_a, along);
      const bool in_slab = -twice_t < twice_d && twice_d <= twice_t && 0 <= foot && foot <= length2;
      if (in_slab || Dot(from_a, from_a) <= r2 || Dot(from_b, from_b) <= r2) {
        pixels.push_back({static_cast<int32_t>(i), static_cast<int32_t>(j)});
      }
    }
  }
}

// d = m[0]*step[0] + m[1]*step[1], m >= 0, det(step) = 1: the octant of d.
struct Octant {
  std::array<Vec2i, 2> step;
  Vec2l m;
};

// Among all cones between two neighbors that contain d, the one with the fewest steps has no neighbor inside.
Octant OctantOf(const Vec2l& d, const std::vector<PlaneFrame>& frames) {
  std::vector<Vec2i> steps;
  for (const PlaneFrame& frame : frames) {
    steps.push_back(frame.q);
    steps.push_back(-frame.q);
  }
  Octant best{};
  bool found = false;
  for (const Vec2i& e0 : steps) {
    for (const Vec2i& e1 : steps) {
      if (Determinant(Mat<int32_t, 2>{e0, e1}) != 1) continue;
      const Vec2l m{d[0] * e1[1] - d[1] * e1[0], e0[0] * d[1] - e0[1] * d[0]};
      if (m[0] < 0 || m[1] < 0 || (found && m[0] + m[1] >= best.m[0] + best.m[1])) continue;
      best = {{e0, e1}, m};
      found = true;
    }
  }
  return best;
}

}  // namespace

std::vector<Segment> RoundToPixels(const std::vector<Segment>& segments, const PlaneLattice& lattice) {
  std::vector<Segment> rounded;
  rounded.reserve(segments.size());
  for (const Segment& segment : segments) {
    rounded.push_back(
        {NearestPixel(lattice, segment.a_lat) * kLatticeUnit, NearestPixel(lattice, segment.b_lat) * kLatticeUnit});
  }
  return rounded;
}

std::vector<Vec2i> BruteForceLines(const std::vector<Segment>& segments, const PlaneLattice& lattice, int k,
                                   StopSignal stop) {
  const double r = LargestInterfaceDistance(lattice, k);
  std::vector<Vec2i> pixels;
  for (const Segment& segment : segments) BruteForceLine(segment, lattice, k, r, stop, pixels);
  SortUnique(pixels, stop);
  return pixels;
}

uint64_t BruteForceCost(const std::vector<Segment>& segments, const PlaneLattice& lattice, int k) {
  const double r = LargestInterfaceDistance(lattice, k);
  uint64_t pixels = 0;
  for (const Segment& segment : segments) {
    const PixelBox box = BoxAround(segment, lattice, r);
    const Vec2l side = box.max - box.min + Vec2l{1, 1};
    pixels += static_cast<uint64_t>(side[0] * side[1]);
  }
  return pixels;
}

std::vector<Vec2i> IncrementalLines(const std::vector<Segment>& segments, const PlaneLattice& lattice, int k,
                                    StopSignal stop) {
  std::vector<Vec2i> pixels;
  for (const Segment& segment : segments) {
    if (stop.Stopped()) return {};
    if (segment.a_lat == segment.b_lat) {
      pixels.push_back(ToPixel(segment.a_lat));
      continue;
    }
    const auto normal = NormalOf(segment);
    const PlaneFrame& frame = PrincipalFrame(lattice.frames(k), normal);
    const FramedSegment framed(segment, frame);
    const int64_t first = framed.x0 / kLatticeUnit, last = framed.x1 / kLatticeUnit;  // exact
    LineWalk walk(framed, frame, first);
    for (int64_t a = first; a <= last; ++a, walk.Next()) pixels.push_back(walk.nearer());
  }
  SortUnique(pixels, stop);
  return pixels;
}

// The error n.(z - from), n the left normal, changes by -m[1] with step 0 and by +m[0] with step 1. On each lattice
// line across the octant the pixels' errors differ by m[0] + m[1], so the smaller of the two is the line's smallest.
std::vector<Vec2i> IbanezLine(const Vec2i& from, const Vec2i& to, const PlaneLattice& lattice, int k) {
  std::vector<Vec2i> line{from};
  const Vec2l d = Wide(to) - Wide(from);
  if (d == Vec2l{}) return line;
  const Octant octant = OctantOf(d, lattice.frames(1 - k));
  // Half way, the end at distance +t.
  const bool tie_to_left = FirstNonzeroIsPositive(Vec2l{-d[1], d[0]});
  Vec2i z = from;
  int64_t error = 0;
  for (int64_t n = octant.m[0] + octant.m[1]; n > 0; --n) {
    const int64_t right = error - octant.m[1], left = error + octant.m[0];
    const bool go_left = left + right < 0 || (left + right == 0 && tie_to_left);
    error = go_left ? left : right;
    z = z + octant.step[go_left ? 1 : 0];
    line.push_back(z);
  }
  return line;
}

std::vector<Vec2i> IbanezLines(const std::vector<Segment>& segments, const PlaneLattice& lattice, int k,
                               StopSignal stop) {
  std::vector<Vec2i> pixels;
  for (const Segment& segment : segments) {
    if (stop.Stopped()) return {};
    const std::vector<Vec2i> line = IbanezLine(ToPixel(segment.a_lat), ToPixel(segment.b_lat), lattice, k);
    pixels.insert(pixels.end(), line.begin(), line.end());
  }
  SortUnique(pixels, stop);
  return pixels;
}

}  // namespace latvox
