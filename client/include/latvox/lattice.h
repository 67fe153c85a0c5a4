// Vectors, and the common lattices.
#ifndef LATVOX_LATVOX_LATTICE_H_
#define LATVOX_LATVOX_LATTICE_H_

#include <array>
#include <cstddef>
#include <cstdint>

namespace latvox::client {

using Vec3d = std::array<double, 3>;   // a world position or vector: x, y, z
using Vec3i = std::array<int32_t, 3>;  // lattice coordinates: i, j, k

// The world vectors of one step in i, j and k.
struct Basis {
  Vec3d a{1, 0, 0};  // of i
  Vec3d b{0, 1, 0};  // of j
  Vec3d c{0, 0, 1};  // of k
  bool operator==(const Basis&) const = default;
};

// The common lattices, in the protocol's order.
enum class NamedLattice {
  kCartesian,  // cubes
  kBcc,        // body-centered cubic
  kFcc,        // face-centered cubic
  kHexagonal,  // hexagonal prism
};

// A common lattice: its value, its name, and its basis up to scale.
struct NamedBasis {
  NamedLattice lattice;  // its value
  const char* name;      // in the protocol, in files and on the command line
  Basis basis;           // up to scale
};

// All of them, in the order of their values.
inline constexpr std::array kNamedLattices{
    NamedBasis{NamedLattice::kCartesian, "cartesian", {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
    NamedBasis{NamedLattice::kBcc, "bcc", {{2, 0, 0}, {0, 2, 0}, {1, 1, 1}}},
    NamedBasis{NamedLattice::kFcc, "fcc", {{1, 1, 0}, {1, 0, 1}, {0, 1, 1}}},
    NamedBasis{NamedLattice::kHexagonal,
               "hexagonal",
               {{1, 0, 0}, {0.5, 0x1.bb67ae8584caap-1, 0}, {0, 0, 1}}},  // (1/2, sqrt(3)/2, 0)
};

// "cartesian", "bcc", "fcc" or "hexagonal".
constexpr const char* NameOf(NamedLattice lattice) { return kNamedLattices[static_cast<size_t>(lattice)].name; }

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_LATTICE_H_
