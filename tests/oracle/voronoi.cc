// The Voronoi cell of the origin, by brute force in exact rationals. A point x (lattice coordinates) is in the cell iff
// 2 x.G.w <= w.G.w for every lattice vector w.
#include <algorithm>
#include <set>
#include <stdexcept>

#include "tests/oracle/oracle.h"

namespace latvox::oracle {
namespace {

template <size_t D>
using Point = std::array<mpq_class, D>;
template <size_t D>
using LatticeVector = std::array<int64_t, D>;
template <size_t D>
using Vectors = std::set<LatticeVector<D>>;

struct PointLess {
  template <size_t D>
  bool operator()(const Point<D>& a, const Point<D>& b) const {
    for (size_t i = 0; i < D; ++i) {
      if (a[i] != b[i]) return a[i] < b[i];
    }
    return false;
  }
};
template <size_t D>
using Points = std::set<Point<D>, PointLess>;

template <size_t D>
Point<D> ToPoint(const LatticeVector<D>& w) {
  Point<D> point;
  for (size_t i = 0; i < D; ++i) point[i] = mpq_class(w[i]);
  return point;
}

template <size_t D>
LatticeVector<D> Negated(LatticeVector<D> w) {
  for (int64_t& c : w) c = -c;
  return w;
}

template <size_t D>
mpq_class Inner(const Gram<D>& gram, const Point<D>& a, const Point<D>& b) {
  mpq_class sum;
  for (size_t i = 0; i < D; ++i) {
    for (size_t j = 0; j < D; ++j) sum += a[i] * gram[i][j] * b[j];
  }
  return sum;
}

// Brings the rows to reduced echelon form, pivots in the first `columns` columns, and returns the rank of those.
template <size_t N>
size_t Eliminate(std::vector<std::array<mpq_class, N>>& rows, size_t columns) {
  size_t rank = 0;
  for (size_t column = 0; column < columns && rank < rows.size(); ++column) {
    size_t pivot = rank;
    while (pivot < rows.size() && rows[pivot][column] == 0) ++pivot;
    if (pivot == rows.size()) continue;
    std::swap(rows[rank], rows[pivot]);
    const mpq_class scale = rows[rank][column];
    for (mpq_class& entry : rows[rank]) entry /= scale;
    for (size_t r = 0; r < rows.size(); ++r) {
      const mpq_class factor = rows[r][column];
      if (r == rank || factor == 0) continue;
      for (size_t c = 0; c < N; ++c) rows[r][c] -= factor * rows[rank][c];
    }
    ++rank;
  }
  return rank;
}

// The half-space nearer to 0 than to w: normal . x <= limit.
template <size_t D>
struct HalfSpace {
  Point<D> normal;
  mpq_class limit;

  HalfSpace(const Gram<D>& gram, const Point<D>& w) : limit(Inner<D>(gram, w, w) / 2) {
    for (size_t i = 0; i < D; ++i) {
      for (size_t j = 0; j < D; ++j) normal[i] += gram[i][j] * w[j];
    }
  }
  // Negative inside, zero on the bisector, positive outside.
  int Side(const Point<D>& x) const {
    mpq_class value = -limit;
    for (size_t i = 0; i < D; ++i) value += normal[i] * x[i];
    return sgn(value);
  }
};

// Calls `use` with every D of the half-spaces.
template <size_t D, typename Use>
void ForEachChoice(const std::vector<HalfSpace<D>>& all, const Use& use) {
  std::array<size_t, D> pick;
  for (size_t i = 0; i < D; ++i) pick[i] = i;
  while (pick[D - 1] < all.size()) {
    use(pick);
    size_t i = D - 1;
    while (i > 0 && pick[i] + (D - i) >= all.size()) --i;
    ++pick[i];
    for (size_t j = i + 1; j < D; ++j) pick[j] = pick[j - 1] + 1;
  }
}

// The vertices of the intersection of the bisector half-spaces of `vectors`.
template <size_t D>
Points<D> Vertices(const Gram<D>& gram, const Vectors<D>& vectors) {
  std::vector<HalfSpace<D>> planes;
  for (const auto& w : vectors) planes.emplace_back(gram, ToPoint<D>(w));
  Points<D> vertices;
  ForEachChoice<D>(planes, [&](const std::array<size_t, D>& pick) {
    std::vector<std::array<mpq_class, D + 1>> rows(D);
    for (size_t i = 0; i < D; ++i) {
      std::copy(planes[pick[i]].normal.begin(), planes[pick[i]].normal.end(), rows[i].begin());
      rows[i][D] = planes[pick[i]].limit;
    }
    if (Eliminate<D + 1>(rows, D) < D) return;
    Point<D> x;
    for (size_t i = 0; i < D; ++i) x[i] = rows[i][D];
    const bool inside =
        std::all_of(planes.begin(), planes.end(), [&x](const HalfSpace<D>& plane) { return plane.Side(x) <= 0; });
    if (inside) vertices.insert(x);
  });
  return vertices;
}

template <size_t D>
Point<D> InverseDiagonal(const Gram<D>& gram) {
  std::vector<std::array<mpq_class, 2 * D>> rows(D);
  for (size_t i = 0; i < D; ++i) {
    std::copy(gram[i].begin(), gram[i].end(), rows[i].begin());
    rows[i][D + i] = 1;
  }
  if (Eliminate<2 * D>(rows, D) < D) throw std::logic_error("a basis is not singular");
  Point<D> diagonal;
  for (size_t i = 0; i < D; ++i) diagonal[i] = rows[i][D + i];
  return diagonal;
}

// All lattice vectors no farther from x than the origin is, the origin left out. If |w-x| <= |x| then, by
// Cauchy-Schwarz, (w[i]-x[i])^2 <= |x|^2 (G^-1)[i][i].
template <size_t D>
Vectors<D> AtLeastAsNear(const Gram<D>& gram, const Point<D>& inverse_diagonal, const Point<D>& x) {
  const mpq_class square = Inner<D>(gram, x, x);
  std::vector<LatticeVector<D>> partial{LatticeVector<D>{}};
  for (size_t i = 0; i < D; ++i) {
    const mpq_class bound = square * inverse_diagonal[i];
    const auto within = [&](int64_t c) -> bool { return (c - x[i]) * (c - x[i]) <= bound; };
    mpz_class whole;
    mpz_fdiv_q(whole.get_mpz_t(), x[i].get_num_mpz_t(), x[i].get_den_mpz_t());
    std::vector<int64_t> values;
    for (int64_t c = whole.get_si(); within(c); --c) values.push_back(c);
    for (int64_t c = whole.get_si() + 1; within(c); ++c) values.push_back(c);
    std::vector<LatticeVector<D>> longer;
    for (LatticeVector<D> w : partial) {
      for (int64_t c : values) {
        w[i] = c;
        longer.push_back(w);
      }
    }
    partial = longer;
  }
  Vectors<D> found;
  for (const auto& w : partial) {
    if (w != LatticeVector<D>{} && HalfSpace<D>(gram, ToPoint<D>(w)).Side(x) >= 0) found.insert(w);
  }
  return found;
}

// Shortens the basis vectors by multiples of each other until none gets shorter; column i of the result is the new i-th
// vector in the old basis. Without it, the cell found first might be so long that it holds millions of points.
template <size_t D>
std::array<LatticeVector<D>, D> ShorterBasis(const Gram<D>& gram) {
  std::array<LatticeVector<D>, D> basis{};
  for (size_t i = 0; i < D; ++i) basis[i][i] = 1;
  bool shorter = true;
  while (shorter) {
    shorter = false;
    for (size_t i = 0; i < D; ++i) {
      for (size_t j = 0; j < D; ++j) {
        if (i == j) continue;
        const Point<D> a = ToPoint<D>(basis[i]);
        const Point<D> b = ToPoint<D>(basis[j]);
        const mpq_class nearest = Inner<D>(gram, a, b) / Inner<D>(gram, b, b) + mpq_class(1, 2);
        mpz_class times;
        mpz_fdiv_q(times.get_mpz_t(), nearest.get_num_mpz_t(), nearest.get_den_mpz_t());
        LatticeVector<D> c = basis[i];
        for (size_t m = 0; m < D; ++m) c[m] -= times.get_si() * basis[j][m];
        if (Inner<D>(gram, ToPoint<D>(c), ToPoint<D>(c)) >= Inner<D>(gram, a, a)) continue;
        basis[i] = c;
        shorter = true;
      }
    }
  }
  return basis;
}

// Dimension of the affine hull.
template <size_t D>
int AffineRank(const std::vector<Point<D>>& points) {
  std::vector<Point<D>> differences;
  for (const Point<D>& point : points) {
    Point<D> difference;
    for (size_t i = 0; i < D; ++i) difference[i] = point[i] - points.front()[i];
    differences.push_back(difference);
  }
  return static_cast<int>(Eliminate<D>(differences, D));
}

// VoronoiNeighbors in the given basis.
template <size_t D>
std::map<LatticeVector<D>, int> CellNeighbors(const Gram<D>& gram) {
  const Point<D> inverse_diagonal = InverseDiagonal<D>(gram);
  // The bisectors of the basis vectors alone bound a parallelepiped that contains the cell.
  Vectors<D> planes;
  for (size_t i = 0; i < D; ++i) {
    LatticeVector<D> unit{};
    unit[i] = 1;
    planes.insert(unit);
    planes.insert(Negated<D>(unit));
  }
  while (true) {
    std::map<LatticeVector<D>, std::vector<Point<D>>> touching;
    Vectors<D> missing;
    for (const Point<D>& vertex : Vertices<D>(gram, planes)) {
      for (const auto& w : AtLeastAsNear<D>(gram, inverse_diagonal, vertex)) {
        if (HalfSpace<D>(gram, ToPoint<D>(w)).Side(vertex) > 0) {
          missing.insert(w);
          missing.insert(Negated<D>(w));
        } else {
          touching[w].push_back(vertex);
        }
      }
    }
    if (missing.empty()) {
      // No lattice point is nearer to a vertex than the origin: the polytope is the Voronoi cell.
      std::map<LatticeVector<D>, int> neighbors;
      for (const auto& [w, vertices] : touching) neighbors[w] = AffineRank<D>(vertices);
      return neighbors;
    }
    // A bisector that touches no vertex does not bound the polytope.
    std::erase_if(planes, [&touching](const LatticeVector<D>& w) { return !touching.contains(w); });
    planes.merge(missing);
  }
}

}  // namespace

template <size_t D>
Gram<D> GramOf(const std::array<std::array<double, D>, D>& columns) {
  Gram<D> gram;
  for (size_t i = 0; i < D; ++i) {
    for (size_t j = 0; j < D; ++j) {
      for (size_t axis = 0; axis < D; ++axis) gram[i][j] += mpq_class(columns[i][axis]) * mpq_class(columns[j][axis]);
    }
  }
  return gram;
}

template <size_t D>
std::map<std::array<int64_t, D>, int> VoronoiNeighbors(const Gram<D>& gram) {
  const auto basis = ShorterBasis<D>(gram);
  Gram<D> shorter;
  for (size_t i = 0; i < D; ++i) {
    for (size_t j = 0; j < D; ++j) shorter[i][j] = Inner<D>(gram, ToPoint<D>(basis[i]), ToPoint<D>(basis[j]));
  }
  std::map<std::array<int64_t, D>, int> neighbors;
  for (const auto& [coefficients, dimension] : CellNeighbors<D>(shorter)) {
    LatticeVector<D> w{};
    for (size_t i = 0; i < D; ++i) {
      for (size_t m = 0; m < D; ++m) w[m] += coefficients[i] * basis[i][m];
    }
    neighbors[w] = dimension;
  }
  return neighbors;
}

std::vector<Int3> Directions(const std::map<Int3, int>& neighbors, int k) {
  std::vector<Int3> directions;
  for (const auto& [w, dimension] : neighbors) {
    if (dimension >= k && w > Int3{}) directions.push_back(w);
  }
  return directions;
}

template Gram<2> GramOf<2>(const std::array<std::array<double, 2>, 2>&);
template Gram<3> GramOf<3>(const std::array<std::array<double, 3>, 3>&);
template std::map<std::array<int64_t, 2>, int> VoronoiNeighbors<2>(const Gram<2>&);
template std::map<std::array<int64_t, 3>, int> VoronoiNeighbors<3>(const Gram<3>&);

}  // namespace latvox::oracle
