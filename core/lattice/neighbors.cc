#include "core/lattice/neighbors.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "absl/status/status.h"
#include "absl/strings/str_format.h"
#include "core/lattice/small_vectors.h"

// Why FindNeighbors is right. The face shared by the cells of 0 and w is centrally symmetric about w/2. So there is one
// iff w/2 lies in the cell of 0, iff w is shortest among w + 2L. The lattice points nearest to w/2 are w/2 + u/2 with u
// in M, the set of shortest vectors of the coset. The face is the intersection of their bisectors, so its dimension is
// D - rank(M).
//
// In doubles, two lengths are equal within a tolerance, and here that errs to the safe side twice. First, a w that may
// be in M is a neighbor. Second, each further member of M takes faces away. Another u of the coset bounds the face of w
// by the bisector of p = (w - u)/2, or of (w + u)/2, at a distance of (|u|^2 - |w|^2) / (8 |p|) from w/2. So u counts
// for w only where that distance is negligible beside the lattice's shortest vector. In a long lattice, |u|^2 and |w|^2
// may differ by little of themselves and by much of that vector.
//
// Why a search over coefficients -3..3 in a reduced basis finds all of M. Let b_0 .. b_D be an obtuse superbase (sum 0,
// p_ij = -b_i.b_j >= 0). Selling's formula gives |sum m_i b_i|^2 = sum_{i<j} p_ij (m_i - m_j)^2. Within a coset, the
// parities of m_i - m_j are fixed, and m in {0,1} attains the smallest value of every term at once. So a shortest
// vector has |m_i - m_j| <= 1 wherever p_ij > 0. The p_ij > 0 connect all D + 1 indices (else the lattice would be
// singular), so |m_i - m_0| <= D.

namespace latvox {
namespace {

constexpr int kMaxSteps = 200;
constexpr int32_t kMaxTransform = 1 << 20;
// A reduced vector shorter than this fraction of the longest given one means that the basis is singular in doubles.
constexpr double kSingular = 1e-10;
constexpr double kDependent = 1e-14;  // share of the volume of the box with sides as long, to within rounding

template <size_t D>
Vec<double, D> Combine(const Mat<double, D>& basis, const Vec<int32_t, D>& coefficients) {
  return Apply(basis, coefficients);
}

template <size_t D>
absl::Status SingularError() {
  return absl::InvalidArgumentError(
      absl::StrFormat("basis: the %d vectors are linearly dependent (rank below %d)", D, D));
}

// Irrational multiples of one vector are dependent, too, although no integer combination of them vanishes.
template <size_t D>
absl::Status TransformError() {
  return absl::InvalidArgumentError(
      absl::StrFormat("basis: the %d vectors are linearly dependent (rank below %d), or so skew that a reduced basis "
                      "takes one of them more than %d times",
                      D, D, kMaxTransform));
}

// A superbase's vectors, by their integer combinations of a basis: rounding never accumulates.
template <size_t D>
using Superbase = std::array<Vec<int32_t, D>, D + 1>;

// Makes the first D vectors so short that none has twice another in it: Selling's steps take away one at a time.
// Returns false if that takes more than kMaxTransform.
template <size_t D>
bool Shorten(const Mat<double, D>& basis, Superbase<D>& t) {
  for (size_t i = 0; i < D; ++i) {
    for (size_t j = 0; j < D; ++j) {
      const auto a = Combine(basis, t[i]), b = Combine(basis, t[j]);
      const double times = std::nearbyint(Dot(a, b) / Dot(b, b));
      if (i == j || Dot(b, b) < kSingular * kSingular || std::abs(times) < 2) continue;
      for (size_t m = 0; m < D; ++m) {
        const double entry = t[i][m] - times * t[j][m];  // exact where it fits
        if (!(std::abs(entry) <= kMaxTransform)) return false;
        t[i][m] = static_cast<int32_t>(entry);
      }
    }
  }
  t[D] = {};
  for (size_t i = 0; i < D; ++i) t[D] = t[D] - t[i];
  return true;
}

// Indices (i, j) of the superbase with the largest positive product, or i == j if there is none.
template <size_t D>
std::pair<size_t, size_t> MostAcutePair(const std::array<Vec<double, D>, D + 1>& b) {
  std::pair<size_t, size_t> pair{0, 0};
  double most = 0;
  for (size_t i = 0; i <= D; ++i) {
    for (size_t j = i + 1; j <= D; ++j) {
      const double dot = Dot(b[i], b[j]);
      // Only rounding is left below this; another step would not end.
      const double noise = 1e-13 * std::sqrt(Dot(b[i], b[i]) * Dot(b[j], b[j]));
      if (dot > noise && dot > most) {
        most = dot;
        pair = {i, j};
      }
    }
  }
  return pair;
}

// The rank of vectors with small entries, not all 0.
size_t Rank(const std::vector<Vec2i>& vectors) {
  for (const auto& v : vectors) {
    if (Determinant(Mat<int32_t, 2>{vectors[0], v}) != 0) return 2;
  }
  return 1;
}

size_t Rank(const std::vector<Vec3i>& vectors) {
  constexpr Vec3i kZero{};
  size_t rank = 1;
  for (const auto& v : vectors) {
    const auto normal = Cross(vectors[0], v);
    if (normal == kZero) continue;
    rank = 2;
    for (const auto& u : vectors) {
      if (Dot(normal, u) != 0) return 3;
    }
  }
  return rank;
}

}  // namespace

template <size_t D>
absl::StatusOr<Mat<int32_t, D>> ReduceBasis(const Mat<double, D>& basis) {
  double largest = 0;
  for (const auto& column : basis) {
    for (double x : column) {
      if (!std::isfinite(x)) return absl::InvalidArgumentError(absl::StrFormat("basis: entry %g is not finite", x));
      largest = std::max(largest, std::abs(x));
    }
  }
  if (largest == 0) return SingularError<D>();
  Mat<double, D> unit = basis;  // keeps squares from over- and underflow
  for (auto& column : unit) column = column * (1 / largest);

  Superbase<D> t{};
  for (size_t i = 0; i < D; ++i) t[i][i] = 1;
  for (int step = 0; step < kMaxSteps; ++step) {
    if (!Shorten(unit, t)) return TransformError<D>();
    std::array<Vec<double, D>, D + 1> b;
    for (size_t i = 0; i <= D; ++i) {
      b[i] = Combine(unit, t[i]);
      if (Dot(b[i], b[i]) < kSingular * kSingular) return SingularError<D>();
    }
    const auto [i, j] = MostAcutePair<D>(b);
    if (i == j) {
      // For dependent vectors, the superbase may fall apart into v, -v and others.
      Mat<double, D> vectors;
      std::copy_n(b.begin(), D, vectors.begin());
      double box = 1;
      for (const auto& v : vectors) box *= std::sqrt(Dot(v, v));
      if (std::abs(Determinant(vectors)) < kDependent * box) return SingularError<D>();
      Mat<int32_t, D> reduced;
      std::copy_n(t.begin(), D, reduced.begin());
      return reduced;
    }
    for (size_t m = 0; m <= D; ++m) {
      if (m != i && m != j) t[m] = t[m] + t[i] * static_cast<int32_t>(D == 2 ? 2 : 1);
    }
    t[i] = -t[i];
    for (const auto& column : t) {
      for (const int32_t x : column) {
        if (std::abs(x) > kMaxTransform) return TransformError<D>();
      }
    }
  }
  return TransformError<D>();
}

template <size_t D>
absl::StatusOr<std::vector<Neighbor<D>>> FindNeighbors(const Mat<double, D>& basis) {
  const auto transform = ReduceBasis<D>(basis);
  if (!transform.ok()) return transform.status();

  struct Candidate {
    Vec<int32_t, D> w;
    Vec<int32_t, D> m;  // the same in the reduced basis: small, where w may have 24 bits an entry
    double length2;
  };
  std::array<std::vector<Candidate>, size_t{1} << D> cosets;
  ForEachInCube<D>(static_cast<int32_t>(D), [&](const Vec<int32_t, D>& m) {
    const Vec<int32_t, D> w = Apply(*transform, m);
    size_t parity = 0;
    for (int32_t x : w) parity = parity << 1 | static_cast<size_t>(x & 1);
    const auto v = Combine(basis, w);
    if (parity != 0) cosets[parity].push_back({w, m, Dot(v, v)});
  });

  // The length of the shortest vector other than 0. That vector is never in 2L, so some coset here has it.
  double least = std::numeric_limits<double>::infinity();
  for (const auto& coset : cosets) {
    for (const auto& c : coset) least = std::min(least, std::sqrt(c.length2));
  }
  std::vector<Neighbor<D>> neighbors;
  for (size_t parity = 1; parity < cosets.size(); ++parity) {
    double shortest = cosets[parity][0].length2;
    for (const auto& c : cosets[parity]) shortest = std::min(shortest, c.length2);
    std::vector<Candidate> minimal;
    for (const auto& c : cosets[parity]) {
      // Twice the tolerance, since these are squares.
      if (c.length2 <= shortest * (1 + 2 * kSymmetryTolerance)) minimal.push_back(c);
    }
    for (const auto& [w, m, length2] : minimal) {
      std::vector<Vec<int32_t, D>> tied;
      for (const auto& u : minimal) {
        const auto difference = Combine(basis, w - u.w), sum = Combine(basis, w + u.w);
        const double p = std::sqrt(std::min(Dot(difference, difference), Dot(sum, sum))) / 2;
        if (u.length2 - length2 <= 4 * kSymmetryTolerance * p * least || u.w == w || u.w == -w) tied.push_back(u.m);
      }
      neighbors.push_back({w, static_cast<int>(D - Rank(tied))});
    }
  }
  std::sort(neighbors.begin(), neighbors.end(), [](const auto& a, const auto& b) { return a.w < b.w; });
  return neighbors;
}

template absl::StatusOr<Mat<int32_t, 2>> ReduceBasis<2>(const Mat<double, 2>&);
template absl::StatusOr<Mat<int32_t, 3>> ReduceBasis<3>(const Mat<double, 3>&);
template absl::StatusOr<std::vector<Neighbor<2>>> FindNeighbors<2>(const Mat<double, 2>&);
template absl::StatusOr<std::vector<Neighbor<3>>> FindNeighbors<3>(const Mat<double, 3>&);

}  // namespace latvox
