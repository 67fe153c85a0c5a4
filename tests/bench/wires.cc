#include "tests/bench/wires.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>

namespace latvox {
namespace {

constexpr uint32_t kSides = 8;
constexpr double kRadius = 0.002;
using Point = std::array<double, 3>;

Point Normalized(Point v) {
  const double length = std::hypot(v[0], v[1], v[2]);
  for (double& x : v) x /= length;
  return v;
}

Point Cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

void AddWire(const Point& from, const Point& to, size_t axis, TriangleMesh& mesh) {
  const Point along = Normalized({to[0] - from[0], to[1] - from[1], to[2] - from[2]});
  Point other{};
  other[(axis + 1) % 3] = 1;  // far from parallel, because the wire rises by 1 along `axis`
  const Point u = Normalized(Cross(along, other)), w = Cross(along, u);
  const auto first = static_cast<uint32_t>(mesh.vertices.size());
  for (const Point& end : {from, to}) {
    for (uint32_t side = 0; side < kSides; ++side) {
      const double angle = 2 * std::numbers::pi * side / kSides;
      Vec3f p;
      for (size_t m = 0; m < 3; ++m) {
        p[m] = static_cast<float>(end[m] + kRadius * (std::cos(angle) * u[m] + std::sin(angle) * w[m]));
      }
      mesh.vertices.push_back(p);
    }
  }
  for (uint32_t side = 0; side < kSides; ++side) {
    const uint32_t a = first + side, b = first + (side + 1) % kSides;
    mesh.triangles.insert(mesh.triangles.end(), {{a, b, a + kSides}, {b, b + kSides, a + kSides}});
  }
}

}  // namespace

TriangleMesh Wires(uint32_t count) {
  TriangleMesh mesh;
  std::mt19937 random(1);  // the standard defines its numbers, and no distribution's
  const auto fraction = [&random] { return static_cast<double>(random()) * 0x1p-32; };
  for (uint32_t n = 0; n < count; ++n) {
    Point from, to;
    for (Point* end : {&from, &to}) {
      for (double& x : *end) x = fraction();
    }
    const size_t axis = n % 3;
    from[axis] = 0;
    to[axis] = 1;
    AddWire(from, to, axis, mesh);
  }
  return mesh;
}

}  // namespace latvox
