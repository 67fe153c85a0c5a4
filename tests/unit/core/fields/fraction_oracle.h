// Fractions by their definition: every finer point by itself, its owner by a search, its inside by the exact oracle.
#ifndef LATVOX_TESTS_UNIT_CORE_FIELDS_FRACTION_ORACLE_H_
#define LATVOX_TESTS_UNIT_CORE_FIELDS_FRACTION_ORACLE_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/lattice/lattice.h"
#include "core/request/solid.h"
#include "tests/oracle/oracle.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/solid/line_fill.h"

namespace latvox {

using IntegerForm = std::array<std::array<int64_t, 3>, 3>;

struct FormedLattice {
  std::string name;
  Lattice lattice;
  IntegerForm form;
};

inline std::vector<FormedLattice> FormedLattices() {
  std::vector<FormedLattice> lattices;
  std::vector<ExactLattice> exact_lattices = ExactLattices();
  // Its cells reach over several steps of the basis.
  exact_lattices.push_back({"skew", *Lattice::FromBasis({{{1, 0, 0}, {2, 1, 0}, {0, 1, 1}}})});
  for (const ExactLattice& exact : exact_lattices) {
    FormedLattice formed{exact.name, exact.lattice, {}};
    const Mat3d& basis = exact.lattice.basis();
    for (size_t c = 0; c < 3; ++c) {
      for (size_t r = 0; r < 3; ++r) formed.form[c][r] = std::llround(Dot(basis[c], basis[r]));
    }
    lattices.push_back(formed);
  }
  lattices.push_back({"hexagonal", Lattice::Named(NamedLattice::kHexagonal), {{{2, 1, 0}, {1, 2, 0}, {0, 0, 2}}}});
  return lattices;
}

// Finds the lattice point that owns a point of the finer lattice. Its distance is the least after the point is shifted
// by -(e, e^2, e^3). That is as if all borders were shifted by (e, e^2, e^3).
class OwnerOracle {
 public:
  //   form   inner products of the basis vectors, up to a common factor
  OwnerOracle(const IntegerForm& form, int64_t n) : n_(n) {
    for (int64_t i = 0; i < n; ++i) {
      for (int64_t j = 0; j < n; ++j) {
        for (int64_t k = 0; k < n; ++k) owners_[{i, j, k}] = Search(form, {i, j, k});
      }
    }
  }

  Int3 OwnerOf(const Int3& point) const {
    Int3 whole, rest;
    for (size_t m = 0; m < 3; ++m) {
      whole[m] = point[m] >= 0 ? point[m] / n_ : -((n_ - 1 - point[m]) / n_);
      rest[m] = point[m] - whole[m] * n_;
    }
    const Int3& owner = owners_.at(rest);
    return {whole[0] + owner[0], whole[1] + owner[1], whole[2] + owner[2]};
  }

 private:
  Int3 Search(const IntegerForm& form, const Int3& point) const {
    constexpr int64_t kFarthest = 6;
    std::optional<std::array<int64_t, 4>> least;
    Int3 owner{};
    for (int64_t i = -kFarthest; i <= kFarthest; ++i) {
      for (int64_t j = -kFarthest; j <= kFarthest; ++j) {
        for (int64_t k = -kFarthest; k <= kFarthest; ++k) {
          const Int3 d{point[0] - n_ * i, point[1] - n_ * j, point[2] - n_ * k};
          // The square of the distance, and its first changes by e, e^2 and e^3.
          std::array<int64_t, 4> distance{};
          for (size_t r = 0; r < 3; ++r) {
            for (size_t c = 0; c < 3; ++c) distance[r + 1] -= 2 * form[c][r] * d[c];
            distance[0] -= distance[r + 1] * d[r] / 2;
          }
          if (least && distance >= *least) continue;
          least = distance;
          owner = {i, j, k};
        }
      }
    }
    return owner;
  }

  int64_t n_;
  std::map<Int3, Int3> owners_;
};

// The fractions other than 0, by voxel.
inline std::map<Int3, int64_t> FractionsOf(const oracle::Mesh& mesh, const OwnerOracle& owners, int64_t n,
                                           InteriorRule rule) {
  oracle::Mesh finer = mesh;
  for (oracle::Triangle& triangle : finer) {
    for (Int3& v : triangle) {
      for (int64_t& x : v) x *= n;
    }
  }
  std::map<Int3, int64_t> fractions;
  for (const Int3& point : FillAlong(finer, {0, 1, 0}, rule).inside) ++fractions[owners.OwnerOf(point)];
  return fractions;
}

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_CORE_FIELDS_FRACTION_ORACLE_H_
