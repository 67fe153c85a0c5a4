// The lattices that have a name: one row of a table each.
#ifndef LATVOX_CORE_LATTICE_NAMED_H_
#define LATVOX_CORE_LATTICE_NAMED_H_

#include <array>
#include <string_view>
#include <type_traits>

#include "core/base/vec.h"

namespace latvox {

// In the order of the protocol's enumerations, which have one more value at the front, "unspecified".
enum class NamedLattice { kCartesian, kBcc, kFcc, kHexagonal };
enum class NamedPlaneLattice { kSquare, kHexagonal };

template <size_t D>
using LatticeName = std::conditional_t<D == 3, NamedLattice, NamedPlaneLattice>;

template <size_t D>
struct NamedBasis {
  LatticeName<D> lattice;
  std::string_view name;
  std::string_view stretched_name;  // with different scales along the axes of the world; "" in the plane
  Mat<double, D> basis;             // columns, up to scale
  std::array<int, D> neighbors;     // |N_k| for k = 0 .. D-1
};

inline constexpr double kHalfRoot3 = 0x1.bb67ae8584caap-1;

inline constexpr std::array<NamedBasis<3>, 4> kNamedLattices{{
    {NamedLattice::kCartesian, "cartesian", "stretched-cartesian", {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {26, 18, 6}},
    // Thesis eq. 4.3.
    {NamedLattice::kBcc, "bcc", "stretched-bcc", {{{2, 0, 0}, {0, 2, 0}, {1, 1, 1}}}, {14, 14, 14}},
    {NamedLattice::kFcc, "fcc", "stretched-fcc", {{{1, 1, 0}, {1, 0, 1}, {0, 1, 1}}}, {18, 12, 12}},
    {NamedLattice::kHexagonal,
     "hexagonal",
     "stretched-hexagonal",
     {{{1, 0, 0}, {0.5, kHalfRoot3, 0}, {0, 0, 1}}},
     {20, 20, 8}},
}};

inline constexpr std::array<NamedBasis<2>, 2> kNamedPlaneLattices{{
    {NamedPlaneLattice::kSquare, "square", "", {{{1, 0}, {0, 1}}}, {8, 4}},
    {NamedPlaneLattice::kHexagonal, "hexagonal", "", {{{1, 0}, {0.5, kHalfRoot3}}}, {6, 6}},
}};

// The row of a lattice.
constexpr const NamedBasis<3>& NamedBasisOf(NamedLattice lattice) {
  return kNamedLattices[static_cast<size_t>(lattice)];
}
constexpr const NamedBasis<2>& NamedBasisOf(NamedPlaneLattice lattice) {
  return kNamedPlaneLattices[static_cast<size_t>(lattice)];
}

namespace named_internal {

template <class Table>
constexpr bool IsInOrder(const Table& table) {
  for (const auto& row : table) {
    if (&NamedBasisOf(row.lattice) != &row) return false;
  }
  return true;
}
static_assert(IsInOrder(kNamedLattices) && IsInOrder(kNamedPlaneLattices));

}  // namespace named_internal

}  // namespace latvox

#endif  // LATVOX_CORE_LATTICE_NAMED_H_
