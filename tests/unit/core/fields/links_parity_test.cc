// Scanned meshes: a link is crossed an odd number of times exactly if one end is inside.
#include "tests/unit/core/fields/links_parity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "tests/unit/core/thesis_meshes.h"

namespace latvox {
namespace {

// The vertices and triangles of a PLY file of text without other properties, or nullopt if there is none.
std::optional<TriangleMesh> ReadTextPly(const std::string& path) {
  std::ifstream file(path);
  size_t vertices = 0, triangles = 0;
  for (std::string word; word != "end_header";) {
    if (!(file >> word)) return std::nullopt;
    if (word == "vertex") file >> vertices;
    if (word == "face") file >> triangles;
  }
  TriangleMesh mesh;
  mesh.vertices.resize(vertices);
  mesh.triangles.resize(triangles);
  for (Vec3f& v : mesh.vertices) file >> v[0] >> v[1] >> v[2];
  for (auto& [a, b, c] : mesh.triangles) {
    int corners = 0;
    file >> corners >> a >> b >> c;
    if (corners != 3) return std::nullopt;
  }
  return file ? std::optional(std::move(mesh)) : std::nullopt;
}

// Closes a mesh by a cone over the edges that an odd number of triangles has. These edges are a cycle modulo 2, so
// every edge of the result has an even number of triangles. Returns how many triangles are new.
size_t Close(TriangleMesh& mesh) {
  std::map<std::pair<uint32_t, uint32_t>, bool> is_odd;
  for (const std::array<uint32_t, 3>& corners : mesh.triangles) {
    for (size_t m = 0; m < 3; ++m) {
      bool& odd = is_odd[std::minmax(corners[m], corners[(m + 1) % 3])];
      odd = !odd;
    }
  }
  const size_t before = mesh.triangles.size();
  for (const auto& [edge, odd] : is_odd) {
    if (odd) mesh.triangles.push_back({edge.first, edge.second, 0});
  }
  return mesh.triangles.size() - before;
}

// Five lattices with about `points` voxels along the mesh's longest side; k in turns.
void ExpectParityOnAllLattices(const TriangleMesh& mesh, double points) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Vec3f low{kInfinity, kInfinity, kInfinity}, high = -low;
  for (const Vec3f& v : mesh.vertices) {
    for (size_t m = 0; m < 3; ++m) {
      low[m] = std::min(low[m], v[m]);
      high[m] = std::max(high[m], v[m]);
    }
  }
  const double step = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]}) / points;
  const Mat3d skewed{{{1, 0, 0}, {0.7, 1.1, 0}, {-0.4, 0.9, 0.8}}};
  int k = 0;
  for (const Lattice& lattice : {Lattice::Named(NamedLattice::kCartesian), Lattice::Named(NamedLattice::kBcc),
                                 Lattice::Named(NamedLattice::kFcc), Lattice::Named(NamedLattice::kHexagonal),
                                 Lattice::FromBasis(skewed).value()}) {
    SCOPED_TRACE(testing::Message() << lattice.name() << " k " << k % 3);
    EXPECT_GT(ExpectParity(mesh, {lattice.Scaled(step).value(), ToDouble(low)}, k++ % 3, false), 10000U);
  }
}

TEST(LinksParity, HoldsOnTheBunny) {
  auto bunny = ReadObj(kBunny);
  ASSERT_TRUE(bunny) << "no " << kBunny << ": install the package glmark2-data";
  EXPECT_EQ(Close(*bunny), 0U);
  ExpectParityOnAllLattices(*bunny, 64);
}

TEST(LinksParity, HoldsOnTheDragonOnceItsHolesAreClosed) {
  constexpr char kFetch[] = "mkdir -p " LATVOX_DRAGON_FOLDER " && " LATVOX_FETCH_DRAGON " " LATVOX_DRAGON_FOLDER;
  ASSERT_EQ(std::system(kFetch), 0) << "tests/bench/fetch-dragon cannot fetch the dragon";
  auto dragon = ReadTextPly(LATVOX_DRAGON_FOLDER "/dragon.ply");
  ASSERT_TRUE(dragon) << "no text of triangles: " LATVOX_DRAGON_FOLDER "/dragon.ply";
  EXPECT_EQ(Close(*dragon), 4270U);
  ExpectParityOnAllLattices(*dragon, 80);
}

}  // namespace
}  // namespace latvox
