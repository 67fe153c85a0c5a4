#include "core/band/metric.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "absl/strings/str_format.h"
#include "core/lattice/common_denominator.h"

namespace latvox {
namespace {

constexpr double kMostOne = static_cast<double>(int64_t{1} << kMetricBits);
constexpr double kMaxEntry = static_cast<double>((int64_t{1} << kMetricEntryBits) - 1);
constexpr double kLeastDeterminant = 0x1p-10;

// Rounds to 48 bits: a number of few bits that is wrong by a few roundings of doubles becomes exact again.
double Rounded(double x) {
  constexpr int kBits = 48;
  int exponent;
  const double fraction = std::frexp(x, &exponent);
  return std::ldexp(std::nearbyint(std::ldexp(fraction, kBits)), exponent - kBits);
}

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
  std::array<double, 9> products;
  for (size_t n = 0; n < 9; ++n) {
    // Divided first, because squares of small basis vectors may underflow.
    products[n] = Dot(basis[n % 3] * (1 / size), basis[n / 3] * (1 / size));
  }
  const double largest = *std::max_element(products.begin(), products.end());
  std::array<double, 9> ratios;
  std::transform(products.begin(), products.end(), ratios.begin(), [&](double product) { return product / largest; });

  Metric metric;
  metric.one = kMostOne;
  double step = 1;  // entries of g are multiples of it
  // For ratios: far more than the error of doubles, and no more than the effect of rounding.
  const double tolerance = std::min(0x1p-46, std::ldexp(0.5, -kMetricBits) / largest);
  const auto denominator = CommonDenominator(ratios, tolerance);
  metric.is_exact = denominator.has_value();
  if (denominator) {
    metric.one = Rounded(static_cast<double>(*denominator) / largest);
    for (; 2 * metric.one <= kMostOne; metric.one *= 2) step *= 2;
  }
  Mat3d g;
  for (size_t n = 0; n < 9; ++n) {
    const double entry = std::nearbyint(products[n] * (metric.one / step)) * step;
    if (!(std::abs(entry) <= kMaxEntry)) {
      return absl::InvalidArgumentError(
          absl::StrFormat("basis: too long in one direction for distances: the square of a vector is %g times that "
                          "of the voxel size, the limit is %g",
                          entry / metric.one, kMaxEntry / metric.one));
    }
    metric.g[n / 3][n % 3] = static_cast<int64_t>(entry);
    g[n / 3][n % 3] = entry / metric.one;
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
