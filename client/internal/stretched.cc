#include "latvox/stretched.h"

#include <cmath>

namespace latvox::client {
namespace {

double VolumeOf(const Basis& basis) {
  const auto& [a, b, c] = basis;
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

}  // namespace

Basis Stretched(NamedLattice lattice, const Vec3d& factors) {
  Basis basis = kNamedLattices[static_cast<size_t>(lattice)].basis;
  const auto volume = static_cast<long double>(std::abs(VolumeOf(basis)));
  const auto side = static_cast<double>(std::cbrt(volume));  // rounded once, as the server does
  for (Vec3d* vector : {&basis.a, &basis.b, &basis.c}) {
    for (size_t axis = 0; axis < 3; ++axis) (*vector)[axis] *= factors[axis] / side;
  }
  return basis;
}

}  // namespace latvox::client
