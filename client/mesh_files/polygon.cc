#include "client/mesh_files/polygon.h"

#include <cmath>
#include <deque>
#include <utility>

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

// Returns whether all triangles of corner 1 and two corners in a row turn left, as those of a convex polygon do.
bool IsFan(const std::vector<Corner>& ring) {
  for (size_t n = 1; n + 1 < ring.size(); ++n) {
    if (!(Turn(ring[0].at, ring[n].at, ring[n + 1].at) > 0)) return false;
  }
  return true;
}

// Cuts ears off a polygon that turns left. Only corners that do not turn left can lie in an ear [Kong, Everett and
// Toussaint 1990], and after a cut only its two neighbors may have become tips of ears. So a polygon of n corners with
// r reflex ones takes about n * r steps.
class EarClipper {
 public:
  explicit EarClipper(std::vector<Corner> corners)
      : corners_(std::move(corners)), before_(corners_.size()), after_(corners_.size()), gone_(corners_.size()) {
    const size_t n = corners_.size();
    for (size_t tip = 0; tip < n; ++tip) {
      before_[tip] = (tip + n - 1) % n;
      after_[tip] = (tip + 1) % n;
    }
    for (size_t tip = 0; tip < n; ++tip) {
      if (!TurnsLeft(tip)) reflex_.push_back(tip);
      tips_.push_back(tip);
    }
  }

  void Clip(std::vector<std::array<uint32_t, 3>>& triangles) {
    bool found = true;  // an ear, since all tips were tried
    for (size_t left = corners_.size(); left >= 3;) {
      if (tips_.empty() && found) {
        found = false;
        for (size_t n = 0, tip = start_; n < left; ++n, tip = after_[tip]) tips_.push_back(tip);
      }
      // Without an ear, the rest has no area or crosses itself. Any corner may be cut, but all must be.
      const bool any = tips_.empty();
      const size_t tip = any ? after_[start_] : tips_.front();
      if (!any) tips_.pop_front();
      if (gone_[tip] || (!any && !IsEar(tip))) continue;
      found |= !any;
      triangles.push_back({corners_[before_[tip]].index, corners_[tip].index, corners_[after_[tip]].index});
      Cut(tip);
      --left;
    }
  }

 private:
  bool TurnsLeft(size_t tip) const {
    return Turn(corners_[before_[tip]].at, corners_[tip].at, corners_[after_[tip]].at) > 0;
  }

  // Returns whether the triangle at `tip` lies inside the polygon: it turns left, and no other corner lies in it.
  // Corners at the position of one of its own do not count. So polygons with slits (a hole joined to the rim) can be
  // cut.
  bool IsEar(size_t tip) {
    if (!TurnsLeft(tip)) return false;
    const Point &a = corners_[before_[tip]].at, &b = corners_[tip].at, &c = corners_[after_[tip]].at;
    for (size_t n = 0; n < reflex_.size();) {
      const size_t other = reflex_[n];
      if (gone_[other] || TurnsLeft(other)) {  // since a cut
        reflex_[n] = reflex_.back();
        reflex_.pop_back();
        continue;
      }
      ++n;
      const Point& p = corners_[other].at;
      const auto same = [&p](const Point& q) { return p.u == q.u && p.v == q.v; };
      if (same(a) || same(b) || same(c)) continue;
      if (Turn(a, b, p) >= 0 && Turn(b, c, p) >= 0 && Turn(c, a, p) >= 0) return false;
    }
    return true;
  }

  void Cut(size_t tip) {
    const size_t before = before_[tip], after = after_[tip];
    const bool before_turned = TurnsLeft(before), after_turned = TurnsLeft(after);
    gone_[tip] = true;
    after_[before] = after;
    before_[after] = before;
    start_ = before;
    // A cut of any corner may make a neighbor reflex.
    if (before_turned && !TurnsLeft(before)) reflex_.push_back(before);
    if (after_turned && !TurnsLeft(after)) reflex_.push_back(after);
    tips_.push_back(before);
    tips_.push_back(after);
  }

  const std::vector<Corner> corners_;
  std::vector<size_t> before_, after_;  // neighbors in what is left
  std::vector<bool> gone_;
  std::vector<size_t> reflex_;  // all corners left that do not turn left, and perhaps others
  std::deque<size_t> tips_;     // to be tried
  size_t start_ = 0;            // a corner that is left
};

}  // namespace

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
  EarClipper(std::move(ring)).Clip(triangles);
}

}  // namespace latvox::client
