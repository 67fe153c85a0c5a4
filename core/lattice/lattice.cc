#include "core/lattice/lattice.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "absl/strings/str_format.h"

namespace latvox {
namespace {

Mat3d Scale(Mat3d m, double s) {
  for (auto& column : m) column = column * s;
  return m;
}

Mat3d Inverse(const Mat3d& m) {
  const double det = Determinant(m);
  const std::array<Vec3d, 3> rows{Cross(m[1], m[2]), Cross(m[2], m[0]), Cross(m[0], m[1])};
  Mat3d inverse;
  for (size_t c = 0; c < 3; ++c) {
    for (size_t r = 0; r < 3; ++r) inverse[c][r] = rows[r][c] / det;
  }
  return inverse;
}

std::string ToString(const Mat3d& m) {
  return absl::StrFormat("%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g", m[0][0], m[0][1], m[0][2], m[1][0], m[1][1],
                         m[1][2], m[2][0], m[2][1], m[2][2]);
}

struct NamedBasis {
  std::string_view name, stretched_name;
  Mat3d basis;
};

// In the order of NamedLattice.
const std::array<NamedBasis, 4>& NamedBases() {
  static const auto* const bases = new std::array<NamedBasis, 4>{{
      {"cartesian", "stretched-cartesian", {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}},
      {"bcc", "stretched-bcc", {{{2, 0, 0}, {0, 2, 0}, {1, 1, 1}}}},
      {"fcc", "stretched-fcc", {{{1, 1, 0}, {1, 0, 1}, {0, 1, 1}}}},
      {"hexagonal", "stretched-hexagonal", {{{1, 0, 0}, {0.5, std::sqrt(0.75), 0}, {0, 0, 1}}}},
  }};
  return *bases;
}

// What the rows of `basis` are multiples of those of `named` by, within the tolerance, if they are, and by numbers
// above 0.
std::optional<Vec3d> StretchOf(const Mat3d& basis, const Mat3d& named) {
  Vec3d stretch;
  for (size_t r = 0; r < 3; ++r) {
    const size_t c = named[0][r] != 0 ? 0 : named[1][r] != 0 ? 1 : 2;
    stretch[r] = basis[c][r] / named[c][r];
    const auto differs = [&](size_t column) {
      return !(std::abs(basis[column][r] - stretch[r] * named[column][r]) <= kSymmetryTolerance * stretch[r]);
    };
    if (!(stretch[r] > 0) || differs(0) || differs(1) || differs(2)) return std::nullopt;
  }
  return stretch;
}

std::string_view NameOf(const Mat3d& basis) {
  for (const NamedBasis& named : NamedBases()) {
    const std::optional<Vec3d> stretch = StretchOf(basis, named.basis);
    if (!stretch) continue;
    const auto [least, most] = std::minmax({(*stretch)[0], (*stretch)[1], (*stretch)[2]});
    return most - least <= kSymmetryTolerance * most ? named.name : named.stretched_name;
  }
  return "basis";
}

// Rounded once: that of doubles is often off by a unit in the last place, and 0.5 would not be the size of 0.5.
double CubeRoot(double x) { return static_cast<double>(std::cbrt(static_cast<long double>(x))); }

absl::Status TooSkewError(const Mat3d& basis, const Mat<int32_t, 3>& transform) {
  Mat3d reduced;
  for (size_t c = 0; c < 3; ++c) reduced[c] = Apply(basis, transform[c]);
  // What else is wrong with it comes first: a basis that is offered is to be taken. Of a flat lattice, the superbase
  // that ReduceBasis finds need not have the shortest vector.
  if (reduced == basis) {
    return absl::InvalidArgumentError("basis: so flat or long that it is too skew for exact 64-bit arithmetic");
  }
  if (const auto lattice = Lattice::FromBasis(reduced); !lattice.ok()) return lattice.status();
  return absl::InvalidArgumentError(absl::StrFormat(
      "basis: too skew for exact 64-bit arithmetic; this basis of the same lattice is not: %s", ToString(reduced)));
}

}  // namespace

double Lattice::voxel_size() const { return CubeRoot(std::abs(Determinant(basis_))); }

absl::StatusOr<Lattice> Lattice::FromBasis(const Mat3d& basis) { return Make(NameOf(basis), basis); }

absl::StatusOr<Lattice> Lattice::Make(std::string_view name, const Mat3d& basis) {
  const auto transform = ReduceBasis<3>(basis);
  if (!transform.ok()) return transform.status();
  const Mat3d inverse = Inverse(basis);
  if (!std::isnormal(Determinant(basis))) {
    return absl::InvalidArgumentError("basis: its determinant over- or underflows");
  }
  for (const auto& column : inverse) {
    for (double x : column) {
      if (!std::isfinite(x)) return absl::InvalidArgumentError("basis: its determinant over- or underflows");
    }
  }
  Lattice lattice(name, basis, inverse);
  auto neighbors = FindNeighbors<3>(basis);
  if (!neighbors.ok()) return neighbors.status();
  lattice.neighbors_ = *std::move(neighbors);
  for (const auto& neighbor : lattice.neighbors_) {
    if (!FirstNonzeroIsPositive(neighbor.w)) continue;
    const auto frame = MakeFrame(neighbor.w);
    if (!frame) return TooSkewError(basis, *transform);
    for (int k = 0; k <= neighbor.face_dimension; ++k) lattice.frames_[static_cast<size_t>(k)].push_back(*frame);
  }
  // Lengths count as equal within a tolerance: of a lattice that is flat or long enough, too many do.
  if (lattice.frames_[0].size() > kMaxPairs) {
    return absl::InvalidArgumentError(
        absl::StrFormat("basis: so flat or long that lengths cannot be told apart: %d directions to neighbours, a "
                        "lattice has %d at most",
                        lattice.frames_[0].size(), kMaxPairs));
  }
  return lattice;
}

Lattice Lattice::Named(NamedLattice name) {
  const NamedBasis& named = NamedBases()[static_cast<size_t>(name)];
  const double size = CubeRoot(std::abs(Determinant(named.basis)));
  return Make(named.name, Scale(named.basis, 1 / size)).value();
}

absl::StatusOr<Lattice> Lattice::Scaled(double voxel_size) const {
  return Make(name_, Scale(basis_, voxel_size / this->voxel_size()));
}

}  // namespace latvox
