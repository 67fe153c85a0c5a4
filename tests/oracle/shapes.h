// Shapes that adversarial meshes consist of. Closed ones are oriented outward.
#ifndef LATVOX_TESTS_ORACLE_SHAPES_H_
#define LATVOX_TESTS_ORACLE_SHAPES_H_

#include <cstdint>
#include <random>

#include "tests/oracle/oracle.h"

namespace latvox::oracle {

inline Int3 operator+(const Int3& a, const Int3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Int3 operator-(const Int3& a, const Int3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Int3 operator*(const Int3& a, int64_t m) { return {a[0] * m, a[1] * m, a[2] * m}; }

// The standard's distributions differ between libraries; its engines do not.
class Random {
 public:
  explicit Random(uint64_t seed) : engine_(seed) {}
  // Uniform enough in [lo, hi].
  int64_t Between(int64_t lo, int64_t hi) {
    return lo + static_cast<int64_t>(engine_() % static_cast<uint64_t>(hi - lo + 1));
  }
  // A multiple of `step` on each axis, at most `reach` from 0.
  Int3 Point(int64_t reach, int64_t step = 1) {
    const int64_t n = reach / step;
    const int64_t x = Between(-n, n);
    const int64_t y = Between(-n, n);
    return Int3{x, y, Between(-n, n)} * step;
  }

 private:
  std::mt19937_64 engine_;
};

void Append(Mesh& mesh, const Mesh& more);

Mesh Reversed(Mesh mesh);

// Returns the mesh with move(v) in place of each vertex v.
template <typename Move>
Mesh Moved(Mesh mesh, const Move& move) {
  for (Triangle& t : mesh) {
    for (Int3& v : t) v = move(v);
  }
  return mesh;
}

Mesh Placed(const Mesh& mesh, int64_t scale, const Int3& at);

Mesh Quad(const Int3& a, const Int3& b, const Int3& c, const Int3& d);

Mesh Tetrahedron(const Int3& a, const Int3& b, const Int3& c, const Int3& d);

Mesh UnitTetrahedron();

// [-1, 1]^3
Mesh UnitCube();

// The octahedron |x|+|y|+|z| = n, each face in n^2 triangles with vertices on integer points: 8 n^2 triangles.
Mesh Octahedron(int64_t n);

// A sphere of 8 n^2 triangles, with integer vertices.
Mesh Sphere(int64_t n, int64_t radius, const Int3& center);

// A closed mesh with a sphere's connectivity and its vertices anywhere: it intersects itself everywhere.
Mesh Crumpled(int64_t n, int64_t reach, int64_t step, Random& random);

}  // namespace latvox::oracle

#endif  // LATVOX_TESTS_ORACLE_SHAPES_H_
