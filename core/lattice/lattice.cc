#include "core/lattice/lattice.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "absl/strings/str_format.h"
#include "core/lattice/cube_root.h"

namespace latvox {
namespace {

template <size_t D>
const auto& NamedBases() {
  if constexpr (D == 3) {
    return kNamedLattices;
  } else {
    return kNamedPlaneLattices;
  }
}

template <size_t D>
Mat<double, D> Scale(Mat<double, D> m, double s) {
  for (auto& column : m) column = column * s;
  return m;
}

// "1,0,0,0,1,0,0,0,1": column by column.
template <size_t D>
std::string ToString(const Mat<double, D>& m) {
  std::string text;
  for (const auto& column : m) {
    for (const double x : column) absl::StrAppendFormat(&text, "%s%.9g", text.empty() ? "" : ",", x);
  }
  return text;
}

// Returns the factors by which the rows of `basis` are multiples of the rows of `named`, within the tolerance. Nullopt
// if they are not multiples, or if a factor is not above 0.
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

std::string_view NameOfBasis(const Mat3d& basis) {
  for (const NamedBasis<3>& named : kNamedLattices) {
    const std::optional<Vec3d> stretch = StretchOf(basis, named.basis);
    if (!stretch) continue;
    const auto [least, most] = std::minmax({(*stretch)[0], (*stretch)[1], (*stretch)[2]});
    return most - least <= kSymmetryTolerance * most ? named.name : named.stretched_name;
  }
  return "basis";
}

std::string_view NameOfBasis(const Mat2d&) { return "basis"; }

// The edge of a cube, or of a square, with a cell's volume. With the library's cube root, 0.5 would not be the size of
// 0.5, and digests would depend on the library.
double EdgeOf(const Mat3d& basis) { return CubeRoot(std::abs(Determinant(basis))); }
double EdgeOf(const Mat2d& basis) { return std::sqrt(std::abs(Determinant(basis))); }

absl::Status DeterminantError() { return absl::InvalidArgumentError("basis: its determinant over- or underflows"); }

template <size_t D>
absl::StatusOr<Mat<double, D>> InverseOf(const Mat<double, D>& basis) {
  const Mat<double, D> inverse = Inverse(basis);
  if (!std::isnormal(Determinant(basis))) return DeterminantError();
  for (const auto& column : inverse) {
    for (const double x : column) {
      if (!std::isfinite(x)) return DeterminantError();
    }
  }
  return inverse;
}

template <size_t D>
absl::Status TooSkewError(const Mat<double, D>& basis, const Mat<int32_t, D>& transform) {
  Mat<double, D> reduced;
  for (size_t c = 0; c < D; ++c) reduced[c] = Apply(basis, transform[c]);
  // Other faults of the lattice come first, because the basis in the message must be accepted. In a flat lattice, the
  // superbase of ReduceBasis need not contain the shortest vector.
  if (reduced == basis) {
    return absl::InvalidArgumentError("basis: so flat or long that it is too skew for exact 64-bit arithmetic");
  }
  if (const auto lattice = BasicLattice<D>::FromBasis(reduced); !lattice.ok()) return lattice.status();
  return absl::InvalidArgumentError(absl::StrFormat(
      "basis: too skew for exact 64-bit arithmetic; this basis of the same lattice is not: %s", ToString<D>(reduced)));
}

// Lengths count as equal within a tolerance. In a lattice that is flat or long enough, too many lengths do. The lists
// of directions in space have room for kMaxPairs; in the plane, extra neighbors do no harm.
absl::Status CheckPairs(const std::vector<Frame>& frames) {
  if (frames.size() <= kMaxPairs) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrFormat("basis: so flat or long that lengths cannot be told apart: %d directions to neighbors, a "
                      "lattice has %d at most",
                      frames.size(), kMaxPairs));
}
absl::Status CheckPairs(const std::vector<PlaneFrame>&) { return absl::OkStatus(); }

}  // namespace

template <size_t D>
double BasicLattice<D>::Size() const {
  return EdgeOf(basis_);
}

template <size_t D>
absl::StatusOr<BasicLattice<D>> BasicLattice<D>::FromBasis(const Mat<double, D>& basis) {
  return Make(NameOfBasis(basis), basis);
}

template <size_t D>
absl::StatusOr<BasicLattice<D>> BasicLattice<D>::Make(std::string_view name, const Mat<double, D>& basis) {
  const auto transform = ReduceBasis<D>(basis);
  if (!transform.ok()) return transform.status();
  const auto inverse = InverseOf<D>(basis);
  if (!inverse.ok()) return inverse.status();
  auto directions = FindDirections(basis, *transform);
  if (!directions.ok()) return directions.status();
  return BasicLattice(name, basis, *inverse, std::make_shared<const Directions>(*std::move(directions)));
}

template <size_t D>
auto BasicLattice<D>::FindDirections(const Mat<double, D>& basis, const Mat<int32_t, D>& reduction)
    -> absl::StatusOr<Directions> {
  auto neighbors = FindNeighbors<D>(basis);
  if (!neighbors.ok()) return neighbors.status();
  Directions directions{*std::move(neighbors), {}};
  for (const auto& neighbor : directions.neighbors) {
    if (!FirstNonzeroIsPositive(neighbor.w)) continue;
    const auto frame = MakeFrame(neighbor.w);
    if (!frame) return TooSkewError<D>(basis, reduction);
    for (int k = 0; k <= neighbor.face_dimension; ++k) directions.frames[static_cast<size_t>(k)].push_back(*frame);
  }
  if (auto status = CheckPairs(directions.frames[0]); !status.ok()) return status;
  return directions;
}

template <size_t D>
BasicLattice<D> BasicLattice<D>::Named(LatticeName<D> lattice) {
  // Never destroyed, because jobs may end after other static objects.
  static const auto* const all = [] {
    auto* const made = new std::vector<BasicLattice>;
    for (const NamedBasis<D>& row : NamedBases<D>()) {
      made->push_back(Make(row.name, Scale<D>(row.basis, 1 / EdgeOf(row.basis))).value());
    }
    return made;
  }();
  return (*all)[static_cast<size_t>(lattice)];
}

template <size_t D>
absl::StatusOr<BasicLattice<D>> BasicLattice<D>::Scaled(double size) const {
  const Mat<double, D> basis = Scale<D>(basis_, size / Size());
  const auto inverse = InverseOf<D>(basis);
  if (!inverse.ok()) return inverse.status();
  return BasicLattice(name_, basis, *inverse, directions_);
}

template class BasicLattice<2>;
template class BasicLattice<3>;

}  // namespace latvox
