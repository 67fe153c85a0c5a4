// Shared by the tests of the thesis's algorithms: its tetrahedron and its bunny.
#ifndef LATVOX_TESTS_UNIT_CORE_THESIS_MESHES_H_
#define LATVOX_TESTS_UNIT_CORE_THESIS_MESHES_H_

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>

#include "core/mesh/mesh.h"
#include "core/snap/snap.h"
#include "core/thesis/thesis.h"
#include "core/voxelizer/voxelizer.h"

namespace latvox {

inline TriangleMesh RotatedTetrahedron(double degrees, double side) {
  const double c = std::cos(degrees * M_PI / 180), s = std::sin(degrees * M_PI / 180), leg = side / std::sqrt(2.0);
  std::array<Vec3d, 4> corners{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Vec3d low{};
  for (Vec3d& p : corners) {
    p = Vec3d{p[0], c * p[1] - s * p[2], s * p[1] + c * p[2]} * leg;
    for (size_t m = 0; m < 3; ++m) low[m] = std::min(low[m], p[m]);
  }
  TriangleMesh mesh{{}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
  for (const Vec3d& p : corners) {
    mesh.vertices.push_back(
        {static_cast<float>(p[0] - low[0]), static_cast<float>(p[1] - low[1]), static_cast<float>(p[2] - low[2])});
  }
  return mesh;
}

// Its share of the cube of that side, which holds it at every angle (thesis section 5.2).
inline const double kTetrahedronVolume = 1 / (6 * std::sqrt(8.0));

// The vertices and faces of an OBJ file, or nullopt if there is none.
inline std::optional<TriangleMesh> ReadObj(const std::string& path) {
  std::ifstream file(path);
  if (!file) return std::nullopt;
  TriangleMesh mesh;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "v") {
      Vec3f v;
      words >> v[0] >> v[1] >> v[2];
      mesh.vertices.push_back(v);
    } else if (word == "f") {
      std::array<uint32_t, 3> t;
      for (uint32_t& n : t) {
        words >> word;
        n = static_cast<uint32_t>(std::stoul(word)) - 1;
      }
      mesh.triangles.push_back(t);
    }
  }
  return mesh;
}
inline constexpr char kBunny[] = "/usr/share/glmark2/models/bunny.obj";

// The surface that the incremental algorithms voxelize: the vertices moved to the nearest lattice points.
inline SnappedMesh Rounded(SnappedMesh mesh, const Lattice& lattice) {
  PaddedVector<Vec3i> vertices_lat;
  for (const Vec3i& v : RoundedVertices(mesh, lattice)) vertices_lat.push_back(v * kLatticeUnit);
  mesh.vertices_lat = std::move(vertices_lat);
  return mesh;
}

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_CORE_THESIS_MESHES_H_
