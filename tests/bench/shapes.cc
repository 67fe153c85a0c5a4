#include "tests/bench/shapes.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>

namespace latvox {
namespace {

using Point = std::array<double, 3>;

// Three unit vectors at right angles, by rows.
using Frame = std::array<Point, 3>;
constexpr Frame kUpright{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
constexpr Frame kTurned{
    // no two of them have the same slope on any axis
    {{-10.0 / 15, 2.0 / 15, 11.0 / 15}, {10.0 / 15, -5.0 / 15, 10.0 / 15}, {5.0 / 15, 14.0 / 15, 2.0 / 15}}};

// Random points of a unit cube.
class Scatter {
 public:
  Point Next() {
    Point p;
    for (double& x : p) x = static_cast<double>(random_()) * 0x1p-32;
    return p;
  }

 private:
  std::mt19937 random_{1};  // the standard defines its numbers, and no distribution's
};

// Adds vertices of a shape, given in the shape's own frame.
class Shape {
 public:
  Shape(TriangleMesh& mesh, const Frame& frame, const Point& at) : mesh_(mesh), frame_(frame), at_(at) {}

  uint32_t Add(double x, double y, double z) {
    const Point own{x, y, z};
    Vec3f p;
    for (size_t m = 0; m < 3; ++m) {
      p[m] = static_cast<float>(at_[m] + own[0] * frame_[0][m] + own[1] * frame_[1][m] + own[2] * frame_[2][m]);
    }
    mesh_.vertices.push_back(p);
    return static_cast<uint32_t>(mesh_.vertices.size() - 1);
  }

  // Adds a circle around the third axis, and returns its first vertex.
  uint32_t AddCircle(uint32_t count, double radius, double z) {
    const auto first = static_cast<uint32_t>(mesh_.vertices.size());
    for (uint32_t n = 0; n < count; ++n) {
      const double angle = 2 * std::numbers::pi * n / count;
      Add(radius * std::cos(angle), radius * std::sin(angle), z);
    }
    return first;
  }

  // Adds the triangles between a vertex and the circle of `count` vertices from `circle` on.
  void AddFan(uint32_t center, uint32_t circle, uint32_t count, bool flipped) {
    for (uint32_t n = 0; n < count; ++n) {
      const uint32_t a = circle + n, b = circle + (n + 1) % count;
      mesh_.triangles.push_back({center, flipped ? b : a, flipped ? a : b});
    }
  }

 private:
  TriangleMesh& mesh_;
  const Frame frame_;
  const Point at_;
};

void AddCylinder(uint32_t sides, double width, const Frame& frame, const Point& at, TriangleMesh& mesh) {
  Shape shape(mesh, frame, at);
  const uint32_t low = shape.AddCircle(sides, width / 2, 0), high = shape.AddCircle(sides, width / 2, width);
  for (uint32_t n = 0; n < sides; ++n) {
    const uint32_t next = (n + 1) % sides;
    mesh.triangles.insert(mesh.triangles.end(), {{low + n, low + next, high + n}, {low + next, high + next, high + n}});
  }
  shape.AddFan(shape.Add(0, 0, 0), low, sides, true);
  shape.AddFan(shape.Add(0, 0, width), high, sides, false);
}

}  // namespace

TriangleMesh Ground() {
  TriangleMesh mesh;
  Shape square(mesh, kUpright, {});
  for (const double y : {0.0, 1.0}) {
    for (const double x : {0.0, 1.0}) square.Add(x, y, 0);
  }
  mesh.triangles.insert(mesh.triangles.end(), {{0, 1, 2}, {1, 3, 2}});
  AddCylinder(64, 1.0 / 32, kUpright, {0.5, 0.5, 0}, mesh);
  return mesh;
}

TriangleMesh Forest(uint32_t count) {
  constexpr double kSide = 1 / (256 * std::numbers::sqrt2);  // of the cube around a tetrahedron
  TriangleMesh mesh;
  Scatter scatter;
  for (uint32_t n = 0; n < count; ++n) {
    Shape tree(mesh, kTurned, scatter.Next());
    const uint32_t a = tree.Add(0, 0, 0), b = tree.Add(kSide, kSide, 0), c = tree.Add(kSide, 0, kSide),
                   d = tree.Add(0, kSide, kSide);
    mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}, {a, d, b}, {b, d, c}});
  }
  return mesh;
}

TriangleMesh Tangle(uint32_t count) {
  TriangleMesh mesh;
  Scatter scatter;
  Shape all(mesh, kUpright, {});
  for (uint32_t n = 0; n < count; ++n) {
    for (int corner = 0; corner < 3; ++corner) {
      const Point p = scatter.Next();
      all.Add(p[0], p[1], p[2]);
    }
    mesh.triangles.push_back({3 * n, 3 * n + 1, 3 * n + 2});
  }
  return mesh;
}

TriangleMesh Fan(uint32_t count) {
  TriangleMesh mesh;
  Shape disk(mesh, kTurned, {});
  const uint32_t center = disk.Add(0, 0, 0);
  disk.AddFan(center, disk.AddCircle(count, 1, 0), count, false);
  return mesh;
}

TriangleMesh Cylinder(uint32_t sides) {
  TriangleMesh mesh;
  AddCylinder(sides, 1, kTurned, {}, mesh);
  return mesh;
}

}  // namespace latvox
