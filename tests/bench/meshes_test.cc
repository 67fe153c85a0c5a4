// Tests of the meshes that latvox_bench generates.
#include "tests/bench/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

namespace latvox {
namespace {

// Returns whether every edge is in two triangles that run along it in opposite directions.
bool IsClosedAndOriented(const TriangleMesh& mesh) {
  std::set<std::pair<uint32_t, uint32_t>> edges;
  for (const auto& t : mesh.triangles) {
    for (size_t m = 0; m < 3; ++m) {
      if (!edges.emplace(t[m], t[(m + 1) % 3]).second) return false;
    }
  }
  for (const auto& [from, to] : edges) {
    if (!edges.contains({to, from})) return false;
  }
  return true;
}

double VolumeOf(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3f &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    sum += double{a[0]} * (double{b[1]} * c[2] - double{b[2]} * c[1]) +
           double{a[1]} * (double{b[2]} * c[0] - double{b[0]} * c[2]) +
           double{a[2]} * (double{b[0]} * c[1] - double{b[1]} * c[0]);
  }
  return sum / 6;
}

TriangleMesh Made(const std::string& name) {
  auto mesh = MeshNamed(name);
  EXPECT_TRUE(mesh.ok()) << mesh.status();
  return *std::move(mesh);
}

TEST(BenchMeshes, BoxIsAClosedCube) {
  const TriangleMesh box = Made("box");
  EXPECT_EQ(box.triangles.size(), 12);
  EXPECT_TRUE(IsClosedAndOriented(box));
  EXPECT_DOUBLE_EQ(VolumeOf(box), 15 * 15 * 15);
}

TEST(BenchMeshes, SpheresAreClosedAndOfAboutAsManyTrianglesAsAsked) {
  for (const int triangles : {8, 32, 1000, 20000}) {
    const TriangleMesh sphere = Made("sphere:" + std::to_string(triangles));
    EXPECT_NEAR(static_cast<double>(sphere.triangles.size()), triangles, triangles * 0.05);
    EXPECT_TRUE(IsClosedAndOriented(sphere)) << triangles;
    EXPECT_EQ(sphere.vertices.size(), sphere.triangles.size() / 2 + 2) << triangles;
  }
  EXPECT_NEAR(VolumeOf(Made("sphere:20000")), 4.0 / 3 * M_PI, 0.01);
}

TEST(BenchMeshes, SubdivisionKeepsTheSurfaceAndSharesVertices) {
  const TriangleMesh sphere = Made("sphere:200"), finer = Subdivided(sphere, 2);
  EXPECT_EQ(finer.triangles.size(), sphere.triangles.size() * 16);
  EXPECT_EQ(finer.vertices.size(), finer.triangles.size() / 2 + 2);
  EXPECT_TRUE(IsClosedAndOriented(finer));
  EXPECT_NEAR(VolumeOf(finer), VolumeOf(sphere), 1e-6);
}

TEST(MeshNamed, WiresHaveSixteenLongThinTrianglesEach) {
  const TriangleMesh wires = Made("wires:20");
  EXPECT_EQ(wires.triangles.size(), 20U * 16);
  EXPECT_EQ(wires.vertices, Made("wires:20").vertices);
  for (const auto& [a, b, c] : wires.triangles) {
    float longest = 0;
    for (const uint32_t end : {b, c}) {
      for (size_t m = 0; m < 3; ++m)
        longest = std::max(longest, std::abs(wires.vertices[end][m] - wires.vertices[a][m]));
    }
    EXPECT_GT(longest, 0.99F);
  }
}

// Loops of one part may meet without shared vertices.
TriangleMesh WithVerticesMerged(TriangleMesh mesh) {
  std::map<Vec3f, uint32_t> first;
  for (auto& triangle : mesh.triangles) {
    for (uint32_t& v : triangle) v = first.try_emplace(mesh.vertices[v], v).first->second;
  }
  return mesh;
}

TEST(BenchMeshes, PartsAreValidAndAlwaysTheSame) {
  for (const char* name : {"gears", "plates", "honeycomb", "threads", "pipes", "city", "shells", "tree"}) {
    const TriangleMesh parts = Made(name);
    EXPECT_TRUE(CheckMesh(parts).ok()) << name;
    EXPECT_GT(parts.triangles.size(), 1000U) << name;
    EXPECT_EQ(parts.vertices, Made(name).vertices) << name;
  }
}

TEST(BenchMeshes, GearsThreadsPipesAndCityAreSolids) {
  for (const char* name : {"gears", "threads", "pipes", "city"}) {
    const TriangleMesh parts = WithVerticesMerged(Made(name));
    EXPECT_TRUE(IsClosedAndOriented(parts)) << name;
    EXPECT_GT(VolumeOf(parts), 0) << name;
  }
}

TEST(BenchMeshes, CylindersAndForestsAreSolids) {
  const TriangleMesh cylinder = Made("cylinder:500"), forest = Made("forest:50");
  EXPECT_EQ(cylinder.triangles.size(), 2000U);
  EXPECT_TRUE(IsClosedAndOriented(cylinder));
  EXPECT_NEAR(VolumeOf(cylinder), M_PI / 4, 1e-3);
  EXPECT_EQ(forest.triangles.size(), 200U);
  EXPECT_TRUE(IsClosedAndOriented(forest));
  EXPECT_NEAR(VolumeOf(forest) / 50, std::pow(1.0 / 256, 3) / (6 * M_SQRT2), 1e-11);
  EXPECT_EQ(forest.vertices, Made("forest:50").vertices);
}

double AreaOf(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    std::array<double, 3> u, v;
    for (size_t m = 0; m < 3; ++m) {
      u[m] = double{mesh.vertices[b][m]} - mesh.vertices[a][m];
      v[m] = double{mesh.vertices[c][m]} - mesh.vertices[a][m];
    }
    sum += std::hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2;
  }
  return sum;
}

TEST(BenchMeshes, ATangleFillsItsCube) {
  const TriangleMesh tangle = Made("tangle:2000");
  EXPECT_EQ(tangle.triangles.size(), 2000U);
  EXPECT_EQ(tangle.vertices, Made("tangle:2000").vertices);
  for (size_t m = 0; m < 3; ++m) {
    double sum = 0;
    for (const Vec3f& p : tangle.vertices) sum += p[m];
    EXPECT_NEAR(sum / 6000, 0.5, 0.02);
  }
}

TEST(BenchMeshes, AFanIsADiskAndTheGroundIsASquareWithASmallObject) {
  const TriangleMesh fan = Made("fan:500"), ground = Made("ground");
  EXPECT_EQ(fan.triangles.size(), 500U);
  EXPECT_NEAR(AreaOf(fan), M_PI, 1e-3);
  EXPECT_EQ(ground.triangles.size(), 2 + 4 * 64U);
  EXPECT_NEAR(AreaOf(ground), 1 + 1.5 * M_PI / (32 * 32), 1e-4);
}

TEST(BenchMeshes, RefusesWhatIsNoNumberOfTriangles) {
  for (const char* name : {"sphere:", "sphere:x", "sphere:7", "sphere:-8", "sphere:67108865", "wires:", "wires:0",
                           "wires:1048577", "forest:0", "tangle:0", "fan:2", "cylinder:2", "cylinder:16777217"}) {
    EXPECT_EQ(MeshNamed(name).status().code(), absl::StatusCode::kInvalidArgument) << name;
  }
}

}  // namespace
}  // namespace latvox
