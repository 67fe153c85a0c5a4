#include "core/plane/lattice2.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "absl/strings/str_format.h"

namespace latvox {
namespace {

int AbsoluteSum(const Vec2i& v) { return std::abs(v[0]) + std::abs(v[1]); }

// Row 0 is the only one, up to sign, that spans the integer vectors orthogonal to q. Row 1 is the smallest vector whose
// product with q is 1; the extended Euclidean algorithm finds one no longer than q, so the search does.
std::optional<PlaneFrame> MakeFrame(const Vec2i& q) {
  if (AbsoluteSum(q) > kMaxPlaneStep) return std::nullopt;
  std::optional<Vec2i> up;
  for (int32_t i = -kMaxPlaneStep; i <= kMaxPlaneStep; ++i) {
    for (int32_t j = -kMaxPlaneStep; j <= kMaxPlaneStep; ++j) {
      const Vec2i row{i, j};
      if (Dot(row, q) == 1 && (!up || AbsoluteSum(row) < AbsoluteSum(*up))) up = row;
    }
  }
  if (!up) return std::nullopt;
  return PlaneFrame{q, {{{q[1], -q[0]}, *up}}, {{{(*up)[1], -(*up)[0]}, q}}};
}

Mat2d Scale(Mat2d m, double s) {
  for (auto& column : m) column = column * s;
  return m;
}

Mat2d Inverse(const Mat2d& m) {
  const double det = Determinant(m);
  return {{{m[1][1] / det, -m[0][1] / det}, {-m[1][0] / det, m[0][0] / det}}};
}

absl::Status TooSkewError(const Mat2d& basis, const Mat<int32_t, 2>& transform) {
  const Vec2d a = Apply(basis, transform[0]), b = Apply(basis, transform[1]);
  return absl::InvalidArgumentError(
      absl::StrFormat("basis: too skew for exact 64-bit arithmetic; this basis of the same lattice is not: "
                      "%.9g,%.9g,%.9g,%.9g",
                      a[0], a[1], b[0], b[1]));
}

}  // namespace

const PlaneFrame& PrincipalFrame(const std::vector<PlaneFrame>& frames, const Vec2l& normal) {
  return *std::max_element(frames.begin(), frames.end(), [&](const PlaneFrame& a, const PlaneFrame& b) {
    return std::abs(Dot(normal, a.q)) < std::abs(Dot(normal, b.q));
  });
}

double PlaneLattice::pixel_size() const { return std::sqrt(std::abs(Determinant(basis_))); }

absl::StatusOr<PlaneLattice> PlaneLattice::FromBasis(const Mat2d& basis) { return Make("basis", basis); }

absl::StatusOr<PlaneLattice> PlaneLattice::Make(std::string_view name, const Mat2d& basis) {
  const auto transform = ReduceBasis<2>(basis);
  if (!transform.ok()) return transform.status();
  const Mat2d inverse = Inverse(basis);
  if (!std::isnormal(Determinant(basis))) {
    return absl::InvalidArgumentError("basis: its determinant over- or underflows");
  }
  for (const auto& column : inverse) {
    for (double x : column) {
      if (!std::isfinite(x)) return absl::InvalidArgumentError("basis: its determinant over- or underflows");
    }
  }
  PlaneLattice lattice(name, basis, inverse);
  auto neighbors = FindNeighbors<2>(basis);
  if (!neighbors.ok()) return neighbors.status();
  lattice.neighbors_ = *std::move(neighbors);
  for (const auto& neighbor : lattice.neighbors_) {
    if (!FirstNonzeroIsPositive(neighbor.w)) continue;
    const auto frame = MakeFrame(neighbor.w);
    if (!frame) return TooSkewError(basis, *transform);
    for (int k = 0; k <= neighbor.face_dimension; ++k) lattice.frames_[static_cast<size_t>(k)].push_back(*frame);
  }
  return lattice;
}

PlaneLattice PlaneLattice::Named(NamedPlaneLattice name) {
  const bool square = name == NamedPlaneLattice::kSquare;
  const Mat2d basis = square ? Mat2d{{{1, 0}, {0, 1}}} : Mat2d{{{1, 0}, {0.5, std::sqrt(0.75)}}};
  const double size = std::sqrt(std::abs(Determinant(basis)));
  return Make(square ? "square" : "hexagonal", Scale(basis, 1 / size)).value();
}

absl::StatusOr<PlaneLattice> PlaneLattice::Scaled(double pixel_size) const {
  return Make(name_, Scale(basis_, pixel_size / this->pixel_size()));
}

}  // namespace latvox
