// The nearest triangle of a voxel, and what the voxel carries of it, by rational distances to all triangles.
#ifndef LATVOX_TESTS_UNIT_CORE_FIELDS_FIELD_ORACLE_H_
#define LATVOX_TESTS_UNIT_CORE_FIELDS_FIELD_ORACLE_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "core/band/metric.h"
#include "core/snap/snap.h"
#include "tests/unit/core/distance.h"
#include "tests/unit/core/exact.h"

namespace latvox {

// The expected nearest triangle of a voxel.
struct FieldAnswer {
  Rational square = -1;                // as Inner
  std::vector<uint32_t> numbers = {};  // of the mesh's fields
  uint32_t triangle = 0;
  std::optional<RationalVec> weights = std::nullopt;  // of the corners in the nearest point; absent without an area
  bool tied = false;                                  // several triangles are at the same distance
};

// The weights of the corners in the point of a triangle with an area that is nearest. It is unique.
inline RationalVec WeightsOf(const Mat<int64_t, 3>& g, const Vec3i& point, const Triangle& corners) {
  const RationalVec e = Difference(corners[1], corners[0]), f = Difference(corners[2], corners[0]);
  const RationalVec d = Difference(point, corners[0]);
  const Rational ee = Inner(g, e, e), ef = Inner(g, e, f), ff = Inner(g, f, f), det = ee * ff - ef * ef;
  const Rational de = Inner(g, d, e), df = Inner(g, d, f);
  const Rational s = (ff * de - ef * df) / det, t = (ee * df - ef * de) / det;
  if (s >= 0 && t >= 0 && s + t <= 1) return {1 - s - t, s, t};
  Rational least = -1;
  RationalVec weights;
  for (size_t n = 0; n < 3; ++n) {
    const size_t next = (n + 1) % 3;
    const RationalVec edge = Difference(corners[next], corners[n]), from = Difference(point, corners[n]);
    const Rational share = std::clamp(Rational(Inner(g, from, edge) / Inner(g, edge, edge)), Rational(0), Rational(1));
    RationalVec rest;
    for (size_t m = 0; m < 3; ++m) rest[m] = from[m] - share * edge[m];
    const Rational square = Inner(g, rest, rest);
    if (least >= 0 && square >= least) continue;
    least = square;
    weights = {0, 0, 0};
    weights[n] = 1 - share;
    weights[next] = share;
  }
  return weights;
}

class FieldOracle {
 public:
  FieldOracle(const TriangleMesh& mesh, const Lattice& lattice, uint32_t count)
      : g_(MakeMetric(lattice).value().g),
        mesh_(Snap(mesh, lattice, {0, 0, 0}, {2, 2, 2}).value()),
        numbers_(mesh.attributes),
        count_(count) {
    for (const auto& [a, b, c] : mesh_.triangles) {
      longest_.push_back(std::max(Distance(At(a), At(b)), Distance(At(a), At(c))));
    }
  }

  FieldAnswer At(const Vec3i& ijk) const {
    const Vec3i point = (ijk - mesh_.base_ijk) * kLatticeUnit;
    Rational nearest_corner = -1;
    FieldAnswer answer;
    bool has_area = false;
    double least = std::numeric_limits<double>::infinity();  // of distances to first corners
    for (const auto& vertices : mesh_.triangles) least = std::min(least, Distance(point, At(vertices[0])));
    for (uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      const auto& vertices = mesh_.triangles[t];
      if (Distance(point, At(vertices[0])) - longest_[t] > 1.001 * least) continue;  // only saves time
      const Triangle triangle = CornersOf(t);
      const Rational square = SquareTo(g_, point, triangle);
      if (answer.square >= 0 && square > answer.square) continue;
      const bool first = answer.square < 0 || square < answer.square;
      answer.tied = !first;
      if (first) nearest_corner = -1;
      answer.square = square;
      if (first || (!has_area && HasArea(triangle))) {
        answer.triangle = t;
        has_area = HasArea(triangle);
        answer.weights = has_area ? std::optional(WeightsOf(g_, point, triangle)) : std::nullopt;
      }
      AddNumbers(point, vertices, nearest_corner, answer);
    }
    return answer;
  }

  Triangle CornersOf(uint32_t t) const {
    const auto& [a, b, c] = mesh_.triangles[t];
    return {At(a), At(b), At(c)};
  }
  static bool HasArea(const Triangle& triangle) {
    const Vec3i e = triangle[1] - triangle[0], f = triangle[2] - triangle[0];
    return Cross(Vec<int64_t, 3>{e[0], e[1], e[2]}, {f[0], f[1], f[2]}) != Vec<int64_t, 3>{};
  }

 private:
  void AddNumbers(const Vec3i& point, const std::array<uint32_t, 3>& vertices, Rational& nearest_corner,
                  FieldAnswer& answer) const {
    for (const uint32_t vertex : vertices) {
      const RationalVec d = Difference(point, At(vertex));
      const Rational to_corner = Inner(g_, d, d);
      if (nearest_corner >= 0 && to_corner > nearest_corner) continue;
      const std::span<const uint32_t> offered = std::span(numbers_).subspan(size_t{vertex} * count_, count_);
      if (nearest_corner < 0 || to_corner < nearest_corner) {
        answer.numbers.assign(offered.begin(), offered.end());
      } else {
        for (size_t n = 0; n < count_; ++n) answer.numbers[n] = std::min(answer.numbers[n], offered[n]);
      }
      nearest_corner = to_corner;
    }
  }

  const Vec3i& At(uint32_t vertex) const { return mesh_.vertices_lat[vertex]; }
  double Distance(const Vec3i& a, const Vec3i& b) const {
    const Vec3d d = ToDouble(b - a);
    double square = 0;
    for (size_t r = 0; r < 3; ++r) {
      for (size_t c = 0; c < 3; ++c) square += d[r] * static_cast<double>(g_[c][r]) * d[c];
    }
    return std::sqrt(square);
  }

  const Mat<int64_t, 3> g_;
  const SnappedMesh mesh_;
  const std::vector<uint32_t> numbers_;
  const uint32_t count_;
  std::vector<double> longest_;  // of each triangle: the farther corner from the first
};

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_CORE_FIELDS_FIELD_ORACLE_H_
