#include "core/band/metric.h"

#include <cmath>

#include "absl/strings/str_format.h"

namespace latvox {
namespace {

constexpr double kOne = static_cast<double>(int64_t{1} << kMetricBits);
constexpr double kMaxEntry = static_cast<double>((int64_t{1} << kMetricEntryBits) - 1);
constexpr double kLeastDeterminant = 0x1p-10;

// Cholesky's decomposition, by columns.
Mat3d RootOf(const Mat3d& g) {
  Mat3d r{};
  r[0][0] = std::sqrt(g[0][0]);
  r[1][0] = g[1][0] / r[0][0];
  r[2][0] = g[2][0] / r[0][0];
  r[1][1] = std::sqrt(g[1][1] - r[1][0] * r[1][0]);
  r[2][1] = (g[2][1] - r[1][0] * r[2][0]) / r[1][1];
  r[2][2] = std::sqrt(g[2][2] - r[2][0] * r[2][0] - r[2][1] * r[2][1]);
  return r;
}

}  // namespace

absl::StatusOr<Metric> MakeMetric(const Lattice& lattice) {
  const Mat3d& basis = lattice.basis();
  const double size = lattice.voxel_size();
  Metric metric;
  Mat3d g;
  for (size_t c = 0; c < 3; ++c) {
    for (size_t r = 0; r < 3; ++r) {
      // Divided first, since squares of small basis vectors may underflow.
      const double entry = std::nearbyint(Dot(basis[r] * (1 / size), basis[c] * (1 / size)) * kOne);
      if (!(std::abs(entry) <= kMaxEntry)) {
        return absl::InvalidArgumentError(
            absl::StrFormat("basis: too long in one direction for distances: the square of a vector is %g times that "
                            "of the voxel size, the limit is %g",
                            entry / kOne, kMaxEntry / kOne));
      }
      metric.g[c][r] = static_cast<int64_t>(entry);
      g[c][r] = entry / kOne;
    }
  }
  const double determinant = Determinant(g);
  if (!(determinant >= kLeastDeterminant * g[0][0] * g[1][1] * g[2][2])) {
    return absl::InvalidArgumentError(
        "basis: too skew for distances; a reduced basis of the same lattice, with shorter vectors, is not");
  }
  metric.root = RootOf(g);
  for (size_t c = 0; c < 3; ++c) metric.cofactor[c] = Cross(metric.root[(c + 1) % 3], metric.root[(c + 2) % 3]);
  metric.determinant = metric.root[0][0] * metric.root[1][1] * metric.root[2][2];
  return metric;
}

}  // namespace latvox
