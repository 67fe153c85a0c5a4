#include "client/tool/output/voronoi_cell.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "client/internal/vec3.h"

namespace latvox::client {
namespace {

constexpr double kTolerance = 1e-9;  // of lengths, relative to the cell

struct LatticeVector {
  Vec3i ijk;
  Vec3d world;
};

// Returns the lattice vectors that may bound the cell, shortest first. The cell lies within `radius` of its point, so
// no vector longer than 2 * radius bounds it. Coordinate i of such a vector is its product with a vector of the dual
// basis, which bounds i.
std::vector<LatticeVector> Candidates(const Basis& basis, double radius) {
  const Vec3d bc = Cross(basis.b, basis.c), ca = Cross(basis.c, basis.a), ab = Cross(basis.a, basis.b);
  const double volume = std::abs(Dot(basis.a, bc));
  Vec3i most{};
  for (const auto& [m, normal] : {std::pair(0, bc), {1, ca}, {2, ab}}) {
    most[static_cast<size_t>(m)] = static_cast<int32_t>(2 * radius * Length(normal) / volume);
  }
  std::vector<LatticeVector> found;
  for (int32_t i = -most[0]; i <= most[0]; ++i) {
    for (int32_t j = -most[1]; j <= most[1]; ++j) {
      for (int32_t k = -most[2]; k <= most[2]; ++k) {
        const Vec3d world = Sum(Sum(Sum({}, i, basis.a), j, basis.b), k, basis.c);
        if (Vec3i{i, j, k} != Vec3i{} && Length(world) <= 2 * radius) found.push_back({{i, j, k}, world});
      }
    }
  }
  std::stable_sort(found.begin(), found.end(), [](const LatticeVector& v, const LatticeVector& w) {
    return Dot(v.world, v.world) < Dot(w.world, w.world);
  });
  return found;
}

using Polygon = std::vector<Vec3d>;

struct Facet {
  Vec3i neighbor;
  Polygon polygon;
};

// A convex body of facets that is cut and closed repeatedly.
class Body {
 public:
  // Begins as a cube around 0.
  explicit Body(double half_side) : tolerance_(kTolerance * half_side) {
    for (size_t m = 0; m < 3; ++m) {
      for (const double side : {-half_side, half_side}) {
        Polygon square;
        for (const auto& [u, v] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}}) {
          Vec3d corner;
          corner[m] = side;
          corner[(m + 1) % 3] = u * half_side;
          corner[(m + 2) % 3] = v * half_side;
          square.push_back(corner);
        }
        facets_.push_back({{}, std::move(square)});
      }
    }
  }

  // Removes the part that is nearer to w than to 0.
  void CutBy(const LatticeVector& w) {
    const double length = Length(w.world);
    const auto beyond = [&](const Vec3d& p) { return Dot(p, w.world) / length - length / 2; };
    Polygon rim;
    bool any = false;
    for (const Facet& facet : facets_) {
      for (const Vec3d& p : facet.polygon) any |= beyond(p) > tolerance_;
    }
    if (!any) return;
    for (Facet& facet : facets_) facet.polygon = Cut(facet.polygon, beyond, rim);
    std::erase_if(facets_, [](const Facet& facet) { return facet.polygon.size() < 3; });
    facets_.push_back({w.ijk, Around(w.world, rim)});
  }

  double Radius() const {
    double radius = 0;
    for (const Facet& facet : facets_) {
      for (const Vec3d& p : facet.polygon) radius = std::max(radius, Length(p));
    }
    return radius;
  }

  VoronoiCell ToCell() const {
    VoronoiCell cell;
    for (const Facet& facet : facets_) {
      CellFace face{facet.neighbor, {}};
      for (const Vec3d& p : facet.polygon) face.corners.push_back(IndexOf(p, cell.corners));
      cell.faces.push_back(std::move(face));
    }
    return cell;
  }

 private:
  bool Same(const Vec3d& p, const Vec3d& q) const { return Length(Sum(p, -1, q)) <= 4 * tolerance_; }

  void Add(const Vec3d& p, Polygon& polygon) const {
    const bool there = std::any_of(polygon.begin(), polygon.end(), [&](const Vec3d& q) { return Same(p, q); });
    if (!there) polygon.push_back(p);
  }

  int IndexOf(const Vec3d& p, std::vector<Vec3d>& corners) const {
    const auto found = std::find_if(corners.begin(), corners.end(), [&](const Vec3d& q) { return Same(p, q); });
    const auto index = found - corners.begin();
    if (found == corners.end()) corners.push_back(p);
    return static_cast<int>(index);
  }

  // Returns the part of the polygon that is not beyond. Adds its points on the border to `rim`.
  template <class Beyond>
  Polygon Cut(const Polygon& polygon, const Beyond& beyond, Polygon& rim) const {
    Polygon kept;
    for (size_t n = 0; n < polygon.size(); ++n) {
      const Vec3d &p = polygon[n], &q = polygon[(n + 1) % polygon.size()];
      const double at_p = beyond(p), at_q = beyond(q);
      if (at_p <= tolerance_) Add(p, kept);
      if (std::abs(at_p) <= tolerance_) Add(p, rim);
      if (std::max(at_p, at_q) > tolerance_ && std::min(at_p, at_q) < -tolerance_) {
        const Vec3d crossing = Sum(p, at_p / (at_p - at_q), Sum(q, -1, p));
        Add(crossing, kept);
        Add(crossing, rim);
      }
    }
    return kept;
  }

  // Returns the corners of a convex polygon counterclockwise about `axis`.
  static Polygon Around(const Vec3d& axis, Polygon corners) {
    Vec3d middle{};
    for (const Vec3d& p : corners) middle = Sum(middle, 1.0 / static_cast<double>(corners.size()), p);
    const Vec3d u = Sum(corners[0], -1, middle), v = Cross(axis, u);
    const double scale = Length(u) / Length(v);
    const auto angle = [&](const Vec3d& p) {
      const Vec3d d = Sum(p, -1, middle);
      return std::atan2(Dot(d, v) * scale, Dot(d, u));
    };
    std::sort(corners.begin(), corners.end(), [&](const Vec3d& p, const Vec3d& q) { return angle(p) < angle(q); });
    return corners;
  }

  double tolerance_;
  std::vector<Facet> facets_;
};

}  // namespace

// Rounding to the nearest multiple of each basis vector leaves at most half the sum of their lengths: this is a radius.
VoronoiCell VoronoiCellOf(const Basis& basis) {
  const double radius = (Length(basis.a) + Length(basis.b) + Length(basis.c)) / 2;
  Body body(radius);
  for (const LatticeVector& w : Candidates(basis, radius)) {
    if (Length(w.world) > 2 * body.Radius()) break;
    body.CutBy(w);
  }
  return body.ToCell();
}

}  // namespace latvox::client
