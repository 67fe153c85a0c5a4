#include "tests/thesis/precision.h"

#include <gmpxx.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "core/thesis/neighborhood.h"

namespace latvox::thesis {
namespace {

using Corners = std::array<Vec3d, 3>;  // world

// The thesis's test of a voxel: Theorem 4, in numbers of type Real.
template <class Real>
class RealSlab {
 public:
  RealSlab(const Corners& corners, const std::vector<Vec3d>& steps) {
    std::array<std::array<Real, 3>, 3> v;
    for (size_t n = 0; n < 3; ++n) v[n] = Narrowed(corners[n]);
    std::array<Real, 3> e, f;
    for (size_t m = 0; m < 3; ++m) {
      e[m] = v[1][m] - v[0][m];
      f[m] = v[2][m] - v[0][m];
    }
    normal_ = {e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]};
    const Real length = std::sqrt(Product(normal_, normal_));
    for (Real& x : normal_) x /= length;
    offset_ = -Product(normal_, v[0]);
    for (const Vec3d& step : steps) t_ = std::max(t_, std::abs(Product(normal_, Narrowed(step))) / 2);
  }
  bool Contains(const Vec3d& point) const {
    const Real d = Product(normal_, Narrowed(point)) + offset_;
    return -t_ < d && d <= t_;
  }

 private:
  static std::array<Real, 3> Narrowed(const Vec3d& a) {
    return {static_cast<Real>(a[0]), static_cast<Real>(a[1]), static_cast<Real>(a[2])};
  }
  static Real Product(const std::array<Real, 3>& a, const std::array<Real, 3>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }
  std::array<Real, 3> normal_;
  Real offset_ = 0, t_ = 0;
};

// The same test, exactly.
class ExactSlab {
 public:
  ExactSlab(const Corners& corners, const std::vector<Vec3d>& steps) : corner_(Wide(corners[0])) {
    const Exact e = Difference(Wide(corners[1]), corner_), f = Difference(Wide(corners[2]), corner_);
    normal_ = {e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]};
    for (const Vec3d& step : steps) two_t_ = std::max(two_t_, mpq_class(abs(Product(normal_, Wide(step)))));
  }
  bool Contains(const Vec3d& point) const {
    const mpq_class two_d = 2 * Product(normal_, Difference(Wide(point), corner_));
    return -two_t_ < two_d && two_d <= two_t_;
  }

 private:
  using Exact = std::array<mpq_class, 3>;
  static Exact Wide(const Vec3d& a) { return {mpq_class(a[0]), mpq_class(a[1]), mpq_class(a[2])}; }
  static Exact Difference(const Exact& a, const Exact& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
  static mpq_class Product(const Exact& a, const Exact& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
  Exact corner_, normal_;
  mpq_class two_t_ = 0;
};

// Distances in doubles, whose errors are far below kNear: they say which points need the exact test.
struct Interior {
  static constexpr double kNear = 1e-3;  // voxels; above the errors of single precision at D = 200, 1e-4

  Interior(const Corners& corners, const std::vector<Vec3d>& steps, double radius) : v(corners), far(radius) {
    normal = Cross(v[1] - v[0], v[2] - v[0]);
    normal = normal * (1 / std::sqrt(Dot(normal, normal)));
    for (size_t n = 0; n < 3; ++n) {
      inward[n] = Cross(normal, v[(n + 1) % 3] - v[n]);
      inward[n] = inward[n] * (1 / std::sqrt(Dot(inward[n], inward[n])));
    }
    for (const Vec3d& step : steps) {
      if (std::abs(Dot(normal, step)) / 2 <= t) continue;
      t = std::abs(Dot(normal, step)) / 2;
      principal = step;
    }
  }
  // How far the point lies from the border of the slab; positive inside.
  double Depth(const Vec3d& point) const { return t - std::abs(Dot(normal, point - v[0])); }
  bool IsFarFromEdges(const Vec3d& point) const {
    for (size_t n = 0; n < 3; ++n) {
      if (Dot(inward[n], point - v[n]) <= far) return false;
    }
    return true;
  }

  Corners v;
  double far, t = 0;
  Vec3d normal, principal{};
  std::array<Vec3d, 3> inward;
};

template <class Real>
class PlaneCheck {
 public:
  PlaneCheck(const Corners& corners, const std::vector<Vec3d>& steps, double radius)
      : real_(corners, steps), exact_(corners, steps), interior_(corners, steps, radius) {}

  void Visit(const Vec3d& point, PrecisionCounts& counts) const {
    const double depth = interior_.Depth(point);
    if (depth < -Interior::kNear || !interior_.IsFarFromEdges(point)) return;
    const bool is_in = real_.Contains(point);
    const bool should_be = depth > Interior::kNear || exact_.Contains(point);
    const bool above = real_.Contains(point + interior_.principal), below = real_.Contains(point - interior_.principal);
    counts.voxels += is_in;
    counts.doubled += is_in && above;
    counts.empty += should_be && !is_in && !above && !below;
    counts.wrong += is_in != should_be;
  }

 private:
  const RealSlab<Real> real_;
  const ExactSlab exact_;
  const Interior interior_;
};

template <class Real>
void CheckPlane(const Corners& exact_corners, const Experiment& experiment, PrecisionCounts& counts) {
  const Grid& grid = experiment.grid;
  const Neighborhood neighborhood(grid.lattice, experiment.k);
  std::vector<Vec3d> steps;
  for (const Frame& frame : neighborhood.frames) steps.push_back(Apply(grid.lattice.basis(), frame.q));
  Corners corners = exact_corners;
  for (Vec3d& corner : corners) {
    for (double& x : corner) x = static_cast<double>(static_cast<Real>(x));
  }
  const PlaneCheck<Real> check(corners, steps, neighborhood.radius);
  Vec3i low, high;
  for (size_t m = 0; m < 3; ++m) {
    std::array<double, 3> x;
    for (size_t n = 0; n < 3; ++n) x[n] = Apply(grid.lattice.inverse(), corners[n] - grid.origin)[m];
    low[m] = static_cast<int32_t>(std::floor(*std::min_element(x.begin(), x.end()))) - 2;
    high[m] = static_cast<int32_t>(std::ceil(*std::max_element(x.begin(), x.end()))) + 2;
  }
  ++counts.planes;
  for (int32_t i = low[0]; i <= high[0]; ++i) {
    for (int32_t j = low[1]; j <= high[1]; ++j) {
      for (int32_t k = low[2]; k <= high[2]; ++k) {
        check.Visit(Apply(grid.lattice.basis(), Vec3i{i, j, k}) + grid.origin, counts);
      }
    }
  }
}

// The planes of a placement. Ties: x + y + z = c with c such that lattice points have n.z + D = -t, t exactly.
std::vector<Corners> PlanesOf(const PrecisionRow& row, const Experiment& experiment,
                              const std::vector<double>& angles) {
  std::vector<Corners> planes;
  if (std::string_view(row.placement) == "ties") {
    const double leg = std::floor(experiment.side / 2) + (row.lattice_case.k == 1 ? 0.5 : 0);
    planes.push_back({Vec3d{1 + leg, 1, 1}, Vec3d{1, 1 + leg, 1}, Vec3d{1, 1, 1 + leg}});
    return planes;
  }
  for (double degrees : angles) {
    const auto corners = TetrahedronCorners(degrees, experiment.side);
    for (const auto& [a, b, c] : kTetrahedronFaces) planes.push_back({corners[a], corners[b], corners[c]});
  }
  return planes;
}

}  // namespace

std::vector<PrecisionRow> PrecisionRows(const Plan& plan) {
  std::vector<PrecisionRow> rows;
  for (const LatticeCase& lattice_case : LatticeCases()) {
    for (int32_t resolution : plan.precision_resolutions) {
      for (const char* placement : {"rotated", "ties"}) {
        for (const char* precision : {"single", "double"}) {
          rows.push_back({lattice_case, resolution, placement, precision, {}});
        }
      }
    }
  }
  oneapi::tbb::parallel_for(size_t{0}, rows.size(), [&](size_t n) {
    PrecisionRow& row = rows[n];
    const Experiment experiment = MakeExperiment(row.lattice_case, row.resolution);
    for (const Corners& corners : PlanesOf(row, experiment, plan.angles)) {
      if (std::string_view(row.precision) == "single") {
        CheckPlane<float>(corners, experiment, row.counts);
      } else {
        CheckPlane<double>(corners, experiment, row.counts);
      }
    }
  });
  return rows;
}

}  // namespace latvox::thesis
