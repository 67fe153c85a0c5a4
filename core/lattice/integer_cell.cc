#include "core/lattice/integer_cell.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <optional>
#include <utility>

#include "absl/strings/str_format.h"
#include "core/lattice/common_denominator.h"
#include "core/lattice/small_vectors.h"

namespace latvox {
namespace {

using Wide = __int128;
// With p_r as multiples of 2^-kZoneBits, the smallest allowed square of the shortest vector: the error is half a
// multiple in each.
constexpr int64_t kMinSquare = 4096;

constexpr std::array<std::array<size_t, 2>, kMaxZones> kPairs{{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

struct Selling {
  std::array<Vec3i, kMaxZones> e;
  std::array<double, kMaxZones> p;
};

Selling SellingOf(const Mat3d& basis, const Mat<int32_t, 3>& reduced) {
  const Mat<int32_t, 3>& t = reduced;
  const int32_t det = Determinant(t);  // +-1
  std::array<Vec3i, 4> coordinate{Cross(t[1], t[2]) * det, Cross(t[2], t[0]) * det, Cross(t[0], t[1]) * det, Vec3i{}};
  std::array<Vec3d, 4> b{Apply(basis, t[0]), Apply(basis, t[1]), Apply(basis, t[2]), {}};
  b[3] = -(b[0] + b[1] + b[2]);
  Selling selling;
  for (size_t r = 0; r < kMaxZones; ++r) {
    const auto [i, j] = kPairs[r];
    selling.e[r] = coordinate[i] - coordinate[j];
    selling.p[r] = -Dot(b[i], b[j]);
  }
  return selling;
}

// Returns whether the cells of all neighbors still meet the origin's if p_r counts: see core/lattice/neighbors.cc.
bool Counts(const Vec3i& e, const std::vector<Neighbor<3>>& neighbors) {
  return std::all_of(neighbors.begin(), neighbors.end(), [&](const auto& n) { return std::abs(Dot(e, n.w)) <= 1; });
}

Vec<Wide, 3> Widened(const Vec<int64_t, 3>& v) { return {v[0], v[1], v[2]}; }

Wide CommonDivisor(Wide a, Wide b) {
  while (b != 0) a = std::exchange(b, a % b);
  return a < 0 ? -a : a;
}

absl::Status FlatError() {
  return absl::InvalidArgumentError(
      "basis: so flat or long that its Voronoi cells cannot be told by integers of 30 bits, which a supercover or a "
      "fraction needs");
}

}  // namespace

absl::StatusOr<IntegerCell> IntegerCell::Of(const Lattice& lattice) {
  const auto reduced = ReduceBasis<3>(lattice.basis());
  if (!reduced.ok()) return reduced.status();
  const Selling selling = SellingOf(lattice.basis(), *reduced);
  const double largest = *std::max_element(selling.p.begin(), selling.p.end());
  std::array<double, kMaxZones> ratios;
  for (size_t r = 0; r < kMaxZones; ++r) {
    ratios[r] = Counts(selling.e[r], lattice.neighbors()) ? selling.p[r] / largest : 0;
  }
  const std::optional<int64_t> denominator = CommonDenominator(ratios, kSymmetryTolerance);
  const int64_t scale = denominator.value_or(int64_t{1} << kZoneBits);
  std::vector<CellZone> zones;
  for (size_t r = 0; r < kMaxZones; ++r) {
    const auto length = static_cast<int64_t>(std::nearbyint(ratios[r] * static_cast<double>(scale)));
    if (length <= 0) continue;
    if (AbsoluteSum(selling.e[r]) > kMaxZoneEntry) {
      return absl::InvalidArgumentError(
          absl::StrFormat("basis: too skew for a supercover or a fraction: a coordinate of its reduced basis takes %d "
                          "steps, the limit is %d",
                          AbsoluteSum(selling.e[r]), kMaxZoneEntry));
    }
    zones.push_back({selling.e[r], length});
  }
  IntegerCell cell;
  cell.SetZones(std::move(zones));
  if (cell.determinant_ == 0) return FlatError();
  for (const auto& neighbor : lattice.neighbors()) {
    int64_t square = 0;
    for (const CellZone& zone : cell.zones_) square += zone.length * std::abs(Dot(zone.e, neighbor.w));
    if (!denominator && square < kMinSquare) return FlatError();
  }
  // A facet is the sum of the zones along it: they must span a plane.
  for (const auto& neighbor : lattice.neighbors()) {
    if (!FirstNonzeroIsPositive(neighbor.w)) continue;
    std::optional<Vec3i> first;
    bool spans = false;
    for (const CellZone& zone : cell.zones_) {
      if (Dot(zone.e, neighbor.w) != 0) continue;
      if (!first) first = zone.e;
      spans |= Cross(*first, zone.e) != Vec3i{};
    }
    if (spans) cell.facets_.push_back(neighbor.w);
  }
  return cell;
}

void IntegerCell::SetZones(std::vector<CellZone> zones) {
  zones_ = std::move(zones);
  for (const CellZone& zone : zones_) {
    while (int64_t{1} << length_bits_ < zone.length) ++length_bits_;
    for (size_t c = 0; c < 3; ++c) {
      for (size_t r = 0; r < 3; ++r) form_[c][r] += zone.length * zone.e[c] * zone.e[r];
    }
  }
  const Mat<Wide, 3> g{Widened(form_[0]), Widened(form_[1]), Widened(form_[2])};
  const Mat<Wide, 3> adjugate{Cross(g[1], g[2]), Cross(g[2], g[0]), Cross(g[0], g[1])};
  determinant_ = Dot(g[0], adjugate[0]);
  for (const CellZone& zone : zones_) directions_.push_back(Apply(adjugate, zone.e));
}

// The cell's edges are p_r G^-1 e_r, and G^-1 is the adjugate over the determinant.
std::optional<CellSegments> IntegerCell::Segments(int32_t most) const {
  Wide common = determinant_;
  std::vector<Vec<Wide, 3>> steps;
  for (size_t r = 0; r < zones_.size(); ++r) {
    steps.push_back(directions_[r] * Wide{zones_[r].length});
    for (const Wide x : steps.back()) common = CommonDivisor(common, x);
  }
  const auto fits = [&](Wide x) { return x / common <= most && x / common >= -most; };
  CellSegments segments;
  for (const Vec<Wide, 3>& step : steps) {
    if (!std::ranges::all_of(step, fits)) return std::nullopt;
    Vec3i small;
    for (size_t m = 0; m < 3; ++m) small[m] = static_cast<int32_t>(step[m] / common);
    segments.steps.push_back(small);
  }
  if (!fits(determinant_)) return std::nullopt;
  segments.parts = static_cast<int32_t>(determinant_ / common);
  return segments;
}

// The adjugate of G is the sum of p_r p_s (e_r x e_s)(e_r x e_s)^T over pairs. The cross products are neighbors (sum of
// absolute entries <= kMaxDirection) or 0, and their products with e_u are 0 or +-1. So entries of directions_ have 2 *
// 30 + 4 + 3 bits, and 121 with a covector. The determinant, a sum over 16 spanning trees (Kirchhoff), has 94. M /
// determinant is twice the vertex on the covector's side. covector . M has more than 128 bits, but doubles estimate the
// quotient well enough to find the remainder modulo 2^128. The vertex's entries are below 2^6, so the estimate is wrong
// by less than 2^20. The remainder is then below 2^116 in size.
__int128 IntegerCell::Support(const Vec<int64_t, 3>& covector, int32_t scale) const {
  using Modular = unsigned __int128;
  Vec<Wide, 3> vertex{};
  for (size_t r = 0; r < zones_.size(); ++r) {
    const Wide along = Dot(Widened(covector), directions_[r]);
    vertex = vertex + directions_[r] * Wide{along > 0 ? zones_[r].length : -zones_[r].length};
  }
  const auto twice = static_cast<double>(determinant_) * 2;
  double estimate = 0;
  Modular product = 0;
  for (size_t m = 0; m < 3; ++m) {
    estimate += static_cast<double>(covector[m]) * (static_cast<double>(vertex[m]) / twice);
    product += static_cast<Modular>(Wide{covector[m]}) * static_cast<Modular>(vertex[m]);
  }
  Wide quotient = static_cast<Wide>(estimate * scale);
  const auto rest = static_cast<Wide>(product * static_cast<Modular>(scale) -
                                      static_cast<Modular>(quotient) * static_cast<Modular>(2 * determinant_));
  const Wide more = rest / (2 * determinant_);
  return quotient + more - (rest - more * 2 * determinant_ < 0 ? 1 : 0);
}

}  // namespace latvox
