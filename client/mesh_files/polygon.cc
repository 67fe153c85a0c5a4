#include "client/mesh_files/polygon.h"

#include <cmath>

namespace latvox::client {
namespace {

struct Point {
  double u, v;
};

struct Corner {
  uint32_t index;
  Point at;
};

// Returns twice the signed area of a, b, c: positive if they turn left.
double Turn(const Point& a, const Point& b, const Point& c) {
  return (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
}

// Returns the polygon projected on the coordinate plane nearest to its mean (Newell) normal, turning left.
std::vector<Corner> Project(std::span<const uint32_t> polygon, const std::vector<Vec3d>& positions) {
  std::array<double, 3> normal{};
  for (size_t n = 0; n < polygon.size(); ++n) {
    const Vec3d& p = positions[polygon[n]];
    const Vec3d& q = positions[polygon[(n + 1) % polygon.size()]];
    for (size_t m = 0; m < 3; ++m) {
      const size_t r = (m + 1) % 3, s = (m + 2) % 3;
      normal[m] += (p[r] - q[r]) * (p[s] + q[s]);
    }
  }
  size_t axis = 0;
  for (size_t m = 1; m < 3; ++m) {
    if (std::abs(normal[m]) > std::abs(normal[axis])) axis = m;
  }
  const double mirror = normal[axis] < 0 ? -1 : 1;
  std::vector<Corner> corners;
  for (const uint32_t index : polygon) {
    const Vec3d& p = positions[index];
    corners.push_back({index, {mirror * p[(axis + 1) % 3], p[(axis + 2) % 3]}});
  }
  return corners;
}

// Returns whether the triangle at `tip` lies inside the polygon: it turns left, and no other corner lies in it. Corners
// at the position of one of its own do not count. So polygons with slits (a hole joined to the rim) can be cut.
bool IsEar(const std::vector<Corner>& ring, size_t tip) {
  const size_t n = ring.size();
  const Point &a = ring[(tip + n - 1) % n].at, &b = ring[tip].at, &c = ring[(tip + 1) % n].at;
  if (!(Turn(a, b, c) > 0)) return false;
  for (size_t other = 0; other < n; ++other) {
    const Point& p = ring[other].at;
    const auto same = [&p](const Point& q) { return p.u == q.u && p.v == q.v; };
    if (same(a) || same(b) || same(c)) continue;
    if (Turn(a, b, p) >= 0 && Turn(b, c, p) >= 0 && Turn(c, a, p) >= 0) return false;
  }
  return true;
}

// Returns whether all triangles of corner 1 and two corners in a row turn left, as those of a convex polygon do.
bool IsFan(const std::vector<Corner>& ring) {
  for (size_t n = 1; n + 1 < ring.size(); ++n) {
    if (!(Turn(ring[0].at, ring[n].at, ring[n + 1].at) > 0)) return false;
  }
  return true;
}

}  // namespace

// Ear clipping: between quadratic and cubic in the corners, which are few in files.
void Triangulate(std::span<const uint32_t> polygon, const std::vector<Vec3d>& positions,
                 std::vector<std::array<uint32_t, 3>>& triangles) {
  if (polygon.size() == 3) {
    triangles.push_back({polygon[0], polygon[1], polygon[2]});
    return;
  }
  std::vector<Corner> ring = Project(polygon, positions);
  if (IsFan(ring)) {
    for (size_t n = 1; n + 1 < polygon.size(); ++n) triangles.push_back({polygon[0], polygon[n], polygon[n + 1]});
    return;
  }
  while (ring.size() >= 3) {
    size_t tip = 0;
    while (tip < ring.size() && !IsEar(ring, tip)) ++tip;
    // Without an ear, the rest has no area or crosses itself. Any corner may be cut, but all must be.
    if (tip == ring.size()) tip = 1;
    const size_t n = ring.size();
    triangles.push_back({ring[(tip + n - 1) % n].index, ring[tip].index, ring[(tip + 1) % n].index});
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(tip));
    if (ring.size() == 2) break;
  }
}

}  // namespace latvox::client
