// Squares of distances without cancellation. With e an edge, d the point relative to its corner, n the normal:
//   to a corner      |d|^2
//   to an edge       |e x d|^2 / |e|^2
//   to the plane     (n . d)^2 det^2 / |n|^2        (n is a covector; det the volume of a voxel)
// where d, e, e x d, n and n . d are exact integers. So each distance is a quotient of squares of lengths.
//
// Signs of inner products decide which of them applies. The signs that separate a corner from an edge may be wrong in
// doubles where |e . d| is below 2^-36 |e||d|; but then the two squares agree to 2^-72. The signs that separate an edge
// from the plane are angles at corners, which slivers make as small as 2^-50. Where doubles cannot decide, integers do.
#include "core/band/triangle_distance.h"

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <utility>

namespace latvox {
namespace {

using Int256 = boost::multiprecision::int256_t;
using Int1024 = boost::multiprecision::int1024_t;
static_assert(2 * kInnerBits + 1 <= 256 && 5 * kInnerBits + 4 <= 1024, "they hold products of two and of five");
static_assert(2 * kPointBits + 1 <= 53, "cross products of differences are exact in doubles");
static_assert(2 * kPointBits + 1 <= 63, "and in int64");

Vec<int64_t, 3> ToWide(const Vec3i& v) { return {v[0], v[1], v[2]}; }

double Square(const Vec3d& v) { return Dot(v, v); }

// n . d, rounded once.
double ExactDot(const Vec<int64_t, 3>& n, const Vec3i& d) {
  constexpr int64_t kNarrow = int64_t{1} << (60 - kPointBits);
  if (std::abs(n[0]) < kNarrow && std::abs(n[1]) < kNarrow && std::abs(n[2]) < kNarrow) {
    return static_cast<double>(Dot(n, d));
  }
  return static_cast<double>(static_cast<__int128>(n[0]) * d[0] + static_cast<__int128>(n[1]) * d[1] +
                             static_cast<__int128>(n[2]) * d[2]);
}

}  // namespace

struct TriangleDistance::Fraction {
  Int1024 over, under;  // under > 0
};

TriangleDistance::TriangleDistance(const Metric& metric, const Triangle& triangle)
    : metric_(metric), corners_(triangle) {
  for (size_t n = 0; n < 3; ++n) {
    edges_[n] = corners_[(n + 1) % 3] - corners_[n];
    edges_world_[n] = Apply(metric.root, ToDouble(edges_[n]));
    edge_squares_[n] = Square(edges_world_[n]);
  }
  normal_ = Cross(ToWide(edges_[2]), ToWide(edges_[0]));
  normal_world_ = Apply(metric.cofactor, ToDouble(normal_));
  normal_square_ = Square(normal_world_);
  unit_normal_ = normal_square_ > 0 ? normal_world_ * (1 / std::sqrt(normal_square_)) : Vec3d{};
  center_ = (edges_world_[0] - edges_world_[2]) * (1.0 / 3);
  radius_ =
      std::sqrt(std::max({Square(center_), Square(edges_world_[0] - center_), Square(edges_world_[2] + center_)}));
}

double TriangleDistance::SquareTo(const Vec3i& point) const {
  std::array<Vec3i, 3> d;
  std::array<Vec3d, 3> d_world, turns;  // root * d, (root * e) x (root * d)
  for (size_t n = 0; n < 3; ++n) {
    d[n] = point - corners_[n];
    d_world[n] = Apply(metric_.root, ToDouble(d[n]));
    turns[n] = Apply(metric_.cofactor, Cross(ToDouble(edges_[n]), ToDouble(d[n])));
  }
  if (ProjectsInside(d, turns)) {
    const double volume = metric_.determinant * ExactDot(normal_, d[0]);
    return volume * volume / normal_square_;
  }
  double least = Square(d_world[0]);
  for (size_t n = 0; n < 3; ++n) {
    const size_t next = (n + 1) % 3;
    if (Dot(edges_world_[n], d_world[n]) > 0 && Dot(edges_world_[n], d_world[next]) < 0) {
      least = std::min(least, Square(turns[n]) / edge_squares_[n]);
    } else {
      least = std::min(least, Square(d_world[next]));
    }
  }
  return least;
}

// Returns whether the nearest point of the plane is in the triangle, edges included.
bool TriangleDistance::ProjectsInside(const std::array<Vec3i, 3>& d, const std::array<Vec3d, 3>& turns) const {
  if (normal_square_ == 0) return false;
  constexpr double kSure = 0x1p-30;
  for (size_t n = 0; n < 3; ++n) {
    const double turn = Dot(normal_world_, turns[n]);
    if (turn * turn > kSure * kSure * normal_square_ * Square(turns[n])) {
      if (turn < 0) return false;
    } else if (!TurnsInward(n, d[n])) {
      return false;
    }
  }
  return true;
}

// Returns whether the point's projection to the plane lies on the triangle's side of the edge, or on the edge's line.
// That is the sign of (e x f) . (e x d) = (e.e)(f.d) - (e.d)(e.f), with f the edge back from the same corner.
bool TriangleDistance::TurnsInward(size_t edge, const Vec3i& d) const {
  const Vec3i &e = edges_[edge], f = -edges_[(edge + 2) % 3];
  return Int256(Inner(metric_, e, e)) * Inner(metric_, f, d) >= Int256(Inner(metric_, e, d)) * Inner(metric_, e, f);
}

// Returns the sign of (e x f) . (e x d): above 0 where the point's projection to the plane lies strictly on the
// triangle's side of the edge, 0 on the edge's line. `d`: from the edge's first corner.
int TriangleDistance::SignOfTurn(size_t edge, const Vec3i& d) const {
  constexpr double kSure = 0x1p-30;
  const Vec3d turn = Apply(metric_.cofactor, Cross(ToDouble(edges_[edge]), ToDouble(d)));
  const double product = Dot(normal_world_, turn);
  if (product * product > kSure * kSure * normal_square_ * Square(turn)) return product > 0 ? 1 : -1;
  const Vec3i &e = edges_[edge], f = -edges_[(edge + 2) % 3];
  const Int256 left = Int256(Inner(metric_, e, e)) * Inner(metric_, f, d);
  return left.compare(Int256(Inner(metric_, e, d)) * Inner(metric_, e, f));
}

// Returns the sign of e . d.
int TriangleDistance::SignAlong(size_t edge, const Vec3i& d) const {
  constexpr double kSure = 0x1p-30;
  const Vec3d d_world = Apply(metric_.root, ToDouble(d));
  const double product = Dot(edges_world_[edge], d_world);
  if (product * product > kSure * kSure * edge_squares_[edge] * Square(d_world)) return product > 0 ? 1 : -1;
  const __int128 exact = Inner(metric_, edges_[edge], d);
  return exact > 0 ? 1 : exact < 0 ? -1 : 0;
}

// A half-plane contains the triangle for each edge. Where the point projects beyond an edge's line or on it, its foot
// on that line is the nearest point of the half-plane. If the foot lies within the edge, it is that of the triangle,
// too. A triangle is convex, so if there is no such edge, and the point does not project into the face, a corner is
// nearest: the one with both its edges behind it.
TriangleFeature TriangleDistance::FeatureNear(const Vec3i& point) const {
  if (!has_area()) return FeatureOfLine(point);
  const std::array<Vec3i, 3> d{point - corners_[0], point - corners_[1], point - corners_[2]};
  bool is_over_face = true;
  for (uint8_t n = 0; n < 3; ++n) {
    if (SignOfTurn(n, d[n]) > 0) continue;
    is_over_face = false;
    if (SignAlong(n, d[n]) > 0 && SignAlong(n, d[(n + 1) % 3]) < 0) return {TriangleFeature::kEdge, n};
  }
  if (is_over_face) return {TriangleFeature::kFace, 0};
  uint8_t corner = 0;
  while (corner < 2 && !(SignAlong(corner, d[corner]) <= 0 && SignAlong((corner + 2) % 3, d[corner]) >= 0)) ++corner;
  return {TriangleFeature::kCorner, corner};
}

// Compares all features, because a corner may lie within an edge.
TriangleFeature TriangleDistance::FeatureOfLine(const Vec3i& point) const {
  const std::array<Vec3i, 3> d{point - corners_[0], point - corners_[1], point - corners_[2]};
  TriangleFeature nearest{TriangleFeature::kCorner, 0};
  Fraction least{Inner(metric_, d[0], d[0]), 1};
  const auto offer = [&](TriangleFeature feature, Fraction square) {
    if (square.over * least.under >= least.over * square.under) return;
    nearest = feature;
    least = std::move(square);
  };
  for (uint8_t n = 1; n < 3; ++n) offer({TriangleFeature::kCorner, n}, {Inner(metric_, d[n], d[n]), 1});
  for (uint8_t n = 0; n < 3; ++n) {
    const __int128 along = Inner(metric_, edges_[n], d[n]), length = Inner(metric_, edges_[n], edges_[n]);
    if (along <= 0 || along >= length) continue;
    offer({TriangleFeature::kEdge, n}, {Int1024(Inner(metric_, d[n], d[n])) * length - Int1024(along) * along, length});
  }
  return nearest;
}

// Numerators and denominators are exact integers, so each weight is a quotient of two rounded ones.
std::array<double, 2> TriangleDistance::WeightsNear(const Vec3i& point, TriangleFeature feature) const {
  if (feature.kind == TriangleFeature::kCorner)
    return {feature.number == 1 ? 1.0 : 0.0, feature.number == 2 ? 1.0 : 0.0};
  if (feature.kind == TriangleFeature::kEdge) {
    const Vec3i& e = edges_[feature.number];
    const __int128 along = Inner(metric_, e, point - corners_[feature.number]), length = Inner(metric_, e, e);
    std::array<double, 3> weights{};
    weights[(feature.number + 1) % 3] = static_cast<double>(along) / static_cast<double>(length);
    weights[feature.number] = static_cast<double>(length - along) / static_cast<double>(length);
    return {weights[1], weights[2]};
  }
  const Vec3i &e = edges_[0], f = -edges_[2], d = point - corners_[0];
  const Int256 ee = Inner(metric_, e, e), ef = Inner(metric_, e, f), ff = Inner(metric_, f, f);
  const Int256 ed = Inner(metric_, e, d), fd = Inner(metric_, f, d);
  const auto determinant = Int256(ee * ff - ef * ef).convert_to<double>();
  return {Int256(ff * ed - ef * fd).convert_to<double>() / determinant,
          Int256(ee * fd - ef * ed).convert_to<double>() / determinant};
}

bool TriangleDistance::IsWithin(const Vec3i& point, __int128 limit) const {
  std::array<Vec3i, 3> d;
  for (size_t n = 0; n < 3; ++n) {
    d[n] = point - corners_[n];
    if (Inner(metric_, d[n], d[n]) <= limit || EdgeIsWithin(n, d[n], limit)) return true;
  }
  return FaceIsWithin(d, limit);
}

// Between the ends of the edge: |d|^2 - (e.d)^2 / |e|^2 <= limit.
bool TriangleDistance::EdgeIsWithin(size_t edge, const Vec3i& d, __int128 limit) const {
  const Vec3i& e = edges_[edge];
  const __int128 along = Inner(metric_, e, d), length = Inner(metric_, e, e);
  if (along <= 0 || along >= length) return false;
  return Int256(Inner(metric_, d, d) - limit) * length <= Int256(along) * along;
}

// Returns whether the point's projection to the plane lies in the triangle, edges included.
bool TriangleDistance::ProjectsInside(const std::array<Vec3i, 3>& d) const {
  if (normal_square_ == 0) return false;
  for (size_t n = 0; n < 3; ++n) {
    if (!TurnsInward(n, d[n])) return false;
  }
  return true;
}

// The part of |d|^2 along the plane is square / determinant, with determinant > 0:
// (G (e.d)^2 - 2 F (e.d)(f.d) + E (f.d)^2) / (E G - F^2).
struct TriangleDistance::Projection {
  Int1024 square, determinant;
};

// `d`: from the first corner. Precondition: the triangle has an area.
TriangleDistance::Projection TriangleDistance::Project(const Vec3i& d) const {
  const Vec3i &e = edges_[0], f = -edges_[2];
  const Int1024 ee = Inner(metric_, e, e), ef = Inner(metric_, e, f), ff = Inner(metric_, f, f);
  const Int1024 ed = Inner(metric_, e, d), fd = Inner(metric_, f, d);
  return {ff * ed * ed - 2 * ef * ed * fd + ee * fd * fd, ee * ff - ef * ef};
}

// Over the triangle: |d|^2 - square / determinant <= limit.
bool TriangleDistance::FaceIsWithin(const std::array<Vec3i, 3>& d, __int128 limit) const {
  if (!ProjectsInside(d)) return false;
  const Projection along = Project(d[0]);
  return (Inner(metric_, d[0], d[0]) - limit) * along.determinant <= along.square;
}

TriangleDistance::Fraction TriangleDistance::ExactSquareTo(const Vec3i& point) const {
  const std::array<Vec3i, 3> d{point - corners_[0], point - corners_[1], point - corners_[2]};
  if (ProjectsInside(d)) {
    const Projection along = Project(d[0]);
    return {Inner(metric_, d[0], d[0]) * along.determinant - along.square, along.determinant};
  }
  Fraction least{Inner(metric_, d[0], d[0]), 1};
  for (size_t n = 0; n < 3; ++n) {
    const Vec3i &e = edges_[n], &next = d[(n + 1) % 3];
    const __int128 along = Inner(metric_, e, d[n]), length = Inner(metric_, e, e);
    Fraction square{Inner(metric_, next, next), 1};
    if (0 < along && along < length) {
      square = {Int1024(Inner(metric_, d[n], d[n])) * length - Int1024(along) * along, length};
    }
    if (square.over * least.under < least.over * square.under) least = square;
  }
  return least;
}

int TriangleDistance::Compare(const TriangleDistance& a, const TriangleDistance& b, const Vec3i& point) {
  const Fraction of_a = a.ExactSquareTo(point), of_b = b.ExactSquareTo(point);
  return Int1024(of_a.over * of_b.under).compare(of_b.over * of_a.under);
}

}  // namespace latvox
