#include "core/digitize/principal_scan.h"

namespace latvox {
namespace {

using Point = Vec<int64_t, 2>;

// Whether p lies in the convex hull of the other points and their negatives: then it never alone attains a maximum of
// |g . q|. It does iff it is in a triangle, possibly flat, of two of them and the origin.
bool IsCovered(const Point& p, const std::vector<Point>& points) {
  const auto det = [](const Point& a, const Point& b) { return a[0] * b[1] - a[1] * b[0]; };
  for (const Point& a : points) {
    for (const Point& b : points) {
      for (const Point& c : {b, -b}) {
        const int64_t area = det(a, c);
        // p = (s a + t c) / area with s = det(p, c), t = det(a, p); inside iff s, t >= 0 and s + t <= area.
        if (area <= 0 || a == p || c == p || a == -p || c == -p) continue;
        for (const Point& r : {p, -p}) {
          const int64_t s = det(r, c), t = det(a, r);
          if (s >= 0 && t >= 0 && s + t <= area) return true;
        }
      }
    }
  }
  return false;
}

}  // namespace

std::vector<ScanFrame> MakeScanFrames(const std::vector<Frame>& frames) {
  std::vector<ScanFrame> scans;
  for (const Frame& frame : frames) {
    std::vector<Point> points;
    for (const Frame& other : frames) {
      const Point p{Dot(frame.r[0], other.q), Dot(frame.r[1], other.q)};
      const bool known = std::any_of(points.begin(), points.end(), [&](const Point& o) { return o == p || o == -p; });
      if (p != Point{} && !known) points.push_back(p);
    }
    ScanFrame scan{frame, {}, 0, 0};
    for (const Point& p : points) {
      if (!IsCovered(p, points)) scan.hull.push_back(p);
      scan.reach_a = std::max(scan.reach_a, std::abs(p[0]));
      scan.reach_b = std::max(scan.reach_b, std::abs(p[1]));
    }
    scans.push_back(scan);
  }
  const auto length = [](const ScanFrame& scan) {
    return std::abs(scan.frame.q[0]) + std::abs(scan.frame.q[1]) + std::abs(scan.frame.q[2]);
  };
  std::stable_sort(scans.begin(), scans.end(),
                   [&](const ScanFrame& a, const ScanFrame& b) { return length(a) < length(b); });
  return scans;
}

const ScanFrame& PrincipalScanFrame(const std::vector<ScanFrame>& frames, const Vec<int64_t, 3>& normal) {
  return *std::max_element(frames.begin(), frames.end(), [&](const ScanFrame& a, const ScanFrame& b) {
    return std::abs(Dot(normal, a.frame.q)) < std::abs(Dot(normal, b.frame.q));
  });
}

}  // namespace latvox
