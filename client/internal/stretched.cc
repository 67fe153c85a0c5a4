#include "latvox/stretched.h"

#include <cmath>
#include <utility>

namespace latvox::client {
namespace {

// The documented basis, and its determinant.
std::pair<Basis, double> Unscaled(NamedLattice lattice) {
  switch (lattice) {
    case NamedLattice::kCartesian:
      break;
    case NamedLattice::kBcc:
      return {{{2, 0, 0}, {0, 2, 0}, {1, 1, 1}}, 4};
    case NamedLattice::kFcc:
      return {{{1, 1, 0}, {1, 0, 1}, {0, 1, 1}}, 2};
    case NamedLattice::kHexagonal:
      return {{{1, 0, 0}, {0.5, std::sqrt(0.75), 0}, {0, 0, 1}}, std::sqrt(0.75)};
  }
  return {{}, 1};
}

}  // namespace

Basis Stretched(NamedLattice lattice, const Vec3d& factors) {
  auto [basis, volume] = Unscaled(lattice);
  const auto side =
      static_cast<double>(std::cbrt(static_cast<long double>(volume)));  // rounded once, as the server does
  for (Vec3d* vector : {&basis.a, &basis.b, &basis.c}) {
    for (size_t axis = 0; axis < 3; ++axis) (*vector)[axis] *= factors[axis] / side;
  }
  return basis;
}

}  // namespace latvox::client
