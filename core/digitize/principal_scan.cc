#include "core/digitize/principal_scan.h"

namespace latvox {
namespace {

using Point = Vec<int64_t, 2>;

// Returns the corners of the convex hull of some points and their negatives, one of each opposite pair. None of the
// other points alone attains a maximum of |g . p|. It uses the lower monotone chain [Andrew 1979]; the upper one is its
// negative.
//   points   at least one; none is 0, and no two are equal or opposite
std::vector<Point> CornersOfHull(std::vector<Point> points) {
  const auto det = [](const Point& a, const Point& b) { return a[0] * b[1] - a[1] * b[0]; };
  for (size_t n = 0, count = points.size(); n < count; ++n) points.push_back(-points[n]);
  std::sort(points.begin(), points.end());
  std::vector<Point> hull;
  for (const Point& p : points) {
    while (hull.size() > 1 && det(hull.back() - hull.end()[-2], p - hull.back()) <= 0) hull.pop_back();
    hull.push_back(p);
  }
  hull.pop_back();  // opposite to the first
  return hull;
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
    ScanFrame scan{frame, CornersOfHull(points), 0, 0};
    for (const Point& p : points) {
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
