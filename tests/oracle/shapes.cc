#include "tests/oracle/shapes.h"

#include <cstdlib>
#include <map>
#include <utility>

namespace latvox::oracle {
namespace {

// The largest r >= 0 with r^2 s <= (a radius)^2, with a's sign: a radius / sqrt(s), truncated, in integers alone.
int64_t Scaled(int64_t a, int64_t radius, int64_t s) {
  const int64_t square = a * a * radius * radius;
  int64_t lo = 0;
  int64_t hi = std::abs(a) * radius;
  while (lo < hi) {
    const int64_t middle = (lo + hi + 1) / 2;
    if (middle * middle * s <= square) {
      lo = middle;
    } else {
      hi = middle - 1;
    }
  }
  return a < 0 ? -lo : lo;
}

}  // namespace

void Append(Mesh& mesh, const Mesh& more) { mesh.insert(mesh.end(), more.begin(), more.end()); }

Mesh Reversed(Mesh mesh) {
  for (Triangle& t : mesh) std::swap(t[1], t[2]);
  return mesh;
}

Mesh Placed(const Mesh& mesh, int64_t scale, const Int3& at) {
  return Moved(mesh, [&](const Int3& v) { return v * scale + at; });
}

Mesh Quad(const Int3& a, const Int3& b, const Int3& c, const Int3& d) { return {{a, b, c}, {a, c, d}}; }

Mesh Tetrahedron(const Int3& a, const Int3& b, const Int3& c, const Int3& d) {
  return {{a, c, b}, {a, b, d}, {b, c, d}, {c, a, d}};
}

Mesh UnitTetrahedron() { return Tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}); }

Mesh UnitCube() {
  Mesh cube;
  for (size_t axis = 0; axis < 3; ++axis) {
    Int3 n{}, u{}, v{};
    n[axis] = 1;
    u[(axis + 1) % 3] = 1;
    v[(axis + 2) % 3] = 1;
    Append(cube, Quad(n - u - v, n + u - v, n + u + v, n - u + v));
    Append(cube, Quad(v - u - n, u + v - n, u - v - n, Int3{} - u - v - n));
  }
  return cube;
}

Mesh Octahedron(int64_t n) {
  Mesh mesh;
  for (int64_t sx : {-1, 1}) {
    for (int64_t sy : {-1, 1}) {
      for (int64_t sz : {-1, 1}) {
        const auto at = [&](int64_t i, int64_t j) { return Int3{sx * i, sy * j, sz * (n - i - j)}; };
        Mesh face;
        for (int64_t i = 0; i < n; ++i) {
          for (int64_t j = 0; i + j < n; ++j) {
            face.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
            if (i + j + 1 < n) face.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
          }
        }
        Append(mesh, sx * sy * sz > 0 ? face : Reversed(face));
      }
    }
  }
  return mesh;
}

Mesh Sphere(int64_t n, int64_t radius, const Int3& center) {
  return Moved(Octahedron(n), [&](const Int3& v) {
    const int64_t s = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    return Int3{Scaled(v[0], radius, s), Scaled(v[1], radius, s), Scaled(v[2], radius, s)} + center;
  });
}

Mesh Crumpled(int64_t n, int64_t reach, int64_t step, Random& random) {
  std::map<Int3, Int3> place;
  return Moved(Octahedron(n), [&](const Int3& v) {
    const auto [found, is_new] = place.try_emplace(v);
    if (is_new) found->second = random.Point(reach, step);
    return found->second;
  });
}

}  // namespace latvox::oracle
