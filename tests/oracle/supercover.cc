// The supercover by clipping, in exact rationals.
#include <algorithm>
#include <cmath>

#include "tests/oracle/oracle.h"

namespace latvox::oracle {
namespace {

template <class T>
using Point = std::array<T, 3>;

int64_t FloorDiv(int64_t n, int64_t d) { return n / d - (n % d < 0 ? 1 : 0); }

// No point is farther from the lattice than half the sum of the lengths of a basis. So a cell lies in a ball of that
// radius. By Cauchy-Schwarz, |x_i|^2 <= |x|^2 (G^-1)_ii.
Int3 MarginOf(const Gram<3>& gram) {
  double radius = 0;
  for (size_t i = 0; i < 3; ++i) radius += std::sqrt(gram[i][i].get_d()) / 2;
  const auto minor = [&](size_t i, size_t j) -> mpq_class { return gram[i][i] * gram[j][j] - gram[i][j] * gram[j][i]; };
  const mpq_class det = gram[0][0] * minor(1, 2) - gram[0][1] * (gram[1][0] * gram[2][2] - gram[1][2] * gram[2][0]) +
                        gram[0][2] * (gram[1][0] * gram[2][1] - gram[1][1] * gram[2][0]);
  Int3 margin;
  for (size_t i = 0; i < 3; ++i) {
    const mpq_class inverse = minor((i + 1) % 3, (i + 2) % 3) / det;
    margin[i] = static_cast<int64_t>(std::ceil(radius * std::sqrt(inverse.get_d()) + 1e-6));
  }
  return margin;
}

Box VoxelsAround(const Triangle& triangle, const Int3& margin) {
  Box box;
  for (size_t m = 0; m < 3; ++m) {
    const auto [low, high] = std::minmax({triangle[0][m], triangle[1][m], triangle[2][m]});
    box.lo[m] = FloorDiv(low, kUnitsPerVoxel) - margin[m];
    box.hi[m] = FloorDiv(high, kUnitsPerVoxel) + 1 + margin[m];
  }
  return box;
}

}  // namespace

// Returns the part of a convex polygon, which may be a segment or a point, in the half-space.
template <class T>
std::vector<Point<T>> CellClipper::Clip(const std::vector<Point<T>>& polygon, const HalfSpace<T>& half_space) {
  const auto beyond = [&](const Point<T>& x) -> T {
    return half_space.normal[0] * x[0] + half_space.normal[1] * x[1] + half_space.normal[2] * x[2] - half_space.limit;
  };
  std::vector<Point<T>> clipped;
  for (size_t n = 0; n < polygon.size(); ++n) {
    const Point<T>&from = polygon[n], &to = polygon[(n + 1) % polygon.size()];
    const T at_from = beyond(from), at_to = beyond(to);
    if (at_from <= 0) clipped.push_back(from);
    if (!((at_from < 0 && at_to > 0) || (at_from > 0 && at_to < 0))) continue;
    const T share = at_from / (at_from - at_to);
    Point<T> between;
    for (size_t m = 0; m < 3; ++m) between[m] = from[m] + share * (to[m] - from[m]);
    clipped.push_back(between);
  }
  return clipped;
}

template <class T>
bool CellClipper::Meets(const Triangle& triangle, const Int3& voxel, const std::vector<HalfSpace<T>>& cell) {
  std::vector<Point<T>> left;
  for (const Int3& v : triangle) {
    Point<T> corner;
    for (size_t m = 0; m < 3; ++m) corner[m] = static_cast<double>(v[m] - voxel[m] * kUnitsPerVoxel);
    left.push_back(corner);
  }
  return std::all_of(cell.begin(), cell.end(), [&](const HalfSpace<T>& half_space) {
    left = Clip(left, half_space);
    return !left.empty();
  });
}

CellClipper::CellClipper(const Gram<3>& gram) : margin_(MarginOf(gram)) {
  for (const auto& [w, dimension] : VoronoiNeighbors<3>(gram)) {
    if (dimension < 2) continue;
    HalfSpace<mpq_class> exact;
    HalfSpace<double> loose{};
    for (size_t i = 0; i < 3; ++i) {
      for (size_t j = 0; j < 3; ++j) exact.normal[i] += gram[i][j] * w[j];
      exact.limit += exact.normal[i] * w[i] * kUnitsPerVoxel / 2;
      loose.normal[i] = exact.normal[i].get_d();
    }
    HalfSpace<double> tight = loose;
    loose.limit = exact.limit.get_d() * 1.001;
    tight.limit = exact.limit.get_d() * 0.999;
    exact_.push_back(exact);
    loose_.push_back(loose);
    tight_.push_back(tight);
  }
}

std::set<Int3> CellClipper::Supercover(const Mesh& mesh, const std::optional<Box>& box) const {
  std::set<Int3> voxels;
  for (const Triangle& triangle : mesh) {
    Box near = VoxelsAround(triangle, margin_);
    for (size_t m = 0; m < 3 && box; ++m) {
      near.lo[m] = std::max(near.lo[m], box->lo[m]);
      near.hi[m] = std::min(near.hi[m], box->hi[m]);
    }
    for (int64_t i = near.lo[0]; i <= near.hi[0]; ++i) {
      for (int64_t j = near.lo[1]; j <= near.hi[1]; ++j) {
        for (int64_t k = near.lo[2]; k <= near.hi[2]; ++k) {
          const Int3 voxel{i, j, k};
          if (!Meets(triangle, voxel, loose_)) continue;
          if (Meets(triangle, voxel, tight_) || Meets(triangle, voxel, exact_)) voxels.insert(voxel);
        }
      }
    }
  }
  return voxels;
}

}  // namespace latvox::oracle
