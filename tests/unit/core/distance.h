// Distances by rational arithmetic that shares nothing with core but the metric, and lattices to measure on.
#ifndef LATVOX_TESTS_UNIT_CORE_DISTANCE_H_
#define LATVOX_TESTS_UNIT_CORE_DISTANCE_H_

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <vector>

#include "core/base/vec.h"
#include "core/digitize/crossing.h"
#include "core/lattice/lattice.h"
#include "tests/unit/dose.h"

namespace latvox {

using Rational = boost::multiprecision::cpp_rational;
using RationalVec = std::array<Rational, 3>;

inline Rational Inner(const Mat<int64_t, 3>& g, const RationalVec& u, const RationalVec& v) {
  Rational sum = 0;
  for (size_t r = 0; r < 3; ++r) {
    for (size_t c = 0; c < 3; ++c) sum += u[r] * g[c][r] * v[c];
  }
  return sum;
}

inline RationalVec Difference(const Vec3i& a, const Vec3i& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

// Uses the nearest point a + s e + t f: that of the plane if it lies in the triangle, else that of one of the edges.
inline Rational SquareTo(const Mat<int64_t, 3>& g, const Vec3i& point, const Triangle& triangle) {
  const RationalVec e = Difference(triangle[1], triangle[0]), f = Difference(triangle[2], triangle[0]);
  const RationalVec d = Difference(point, triangle[0]);
  const auto square_at = [&](const RationalVec& from, const RationalVec& along, const Rational& s) {
    RationalVec rest;
    for (size_t m = 0; m < 3; ++m) rest[m] = from[m] - s * along[m];
    return Inner(g, rest, rest);
  };
  const Rational ee = Inner(g, e, e), ef = Inner(g, e, f), ff = Inner(g, f, f), det = ee * ff - ef * ef;
  if (det != 0) {
    const Rational de = Inner(g, d, e), df = Inner(g, d, f);
    const Rational s = (ff * de - ef * df) / det, t = (ee * df - ef * de) / det;
    if (s >= 0 && t >= 0 && s + t <= 1) {
      RationalVec rest;
      for (size_t m = 0; m < 3; ++m) rest[m] = d[m] - s * e[m] - t * f[m];
      return Inner(g, rest, rest);
    }
  }
  Rational least = Inner(g, d, d);
  for (size_t n = 0; n < 3; ++n) {
    const RationalVec edge = Difference(triangle[(n + 1) % 3], triangle[n]), from = Difference(point, triangle[n]);
    const Rational length = Inner(g, edge, edge);
    const Rational s = length == 0 ? Rational(0) : Rational(Inner(g, from, edge) / length);
    least = std::min(least, square_at(from, edge, std::clamp(s, Rational(0), Rational(1))));
  }
  return least;
}

inline Lattice Triclinic() { return Lattice::FromBasis({{{4, 1, 1}, {0, 4, 1}, {0, 0, 4}}}).value(); }

inline std::vector<Lattice> Lattices() {
  std::vector<Lattice> lattices;
  for (const NamedLattice name :
       {NamedLattice::kCartesian, NamedLattice::kBcc, NamedLattice::kFcc, NamedLattice::kHexagonal}) {
    lattices.push_back(Lattice::Named(name).Scaled(0.7).value());
  }
  lattices.push_back(Triclinic());
  lattices.push_back(Lattice::FromBasis({{{0, 0.3, 0}, {0.1, 0, 0.02}, {0.03, 0.1, 0.7}}}).value());
  if (kSlowed) lattices = {lattices[1], lattices[4], lattices[5]};
  return lattices;
}

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_CORE_DISTANCE_H_
