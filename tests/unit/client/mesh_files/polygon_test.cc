// Polygons cut into triangles.
#include "client/mesh_files/polygon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "client/mesh_files/obj_file.h"

namespace latvox::client {
namespace {

using Triangle = std::array<uint32_t, 3>;

// Returns the signed area as seen from +z.
double Area(const Mesh& mesh, const Triangle& t) {
  const Vec3d &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
  return ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
}

TEST(Polygon, QuadsBecomeTwoTrianglesWithTheSameSense) {
  const auto mesh = ParseObj("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1/1/1 2/2/1 3//1 4\n");
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  ASSERT_EQ(mesh->triangles.size(), 2u);
  EXPECT_EQ(Area(*mesh, mesh->triangles[0]), 0.5);
  EXPECT_EQ(Area(*mesh, mesh->triangles[1]), 0.5);
}

TEST(Polygon, ConcavePentagonIsCutInsideFromEveryCornerOn) {
  // A house upside down: corner 4 is a dent of depth 1.5 into a square of side 2.
  const std::string vertices = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 1 0.5 0\nv 0 2 0\n";
  for (int first = 0; first < 5; ++first) {
    std::string face = "f";
    for (int n = 0; n < 5; ++n) face += " " + std::to_string((first + n) % 5 + 1);
    const auto mesh = ParseObj(vertices + face + "\n");
    ASSERT_TRUE(mesh.ok());
    ASSERT_EQ(mesh->triangles.size(), 3u);
    double area = 0;
    for (const Triangle& t : mesh->triangles) {
      EXPECT_GT(Area(*mesh, t), 0);  // no triangle is turned over, so none lies outside
      area += Area(*mesh, t);
    }
    EXPECT_DOUBLE_EQ(area, 2.5);
  }
}

TEST(Polygon, RotatedConcaveQuadIsCutInsideInEveryCoordinatePlane) {
  for (size_t axis = 0; axis < 3; ++axis) {
    for (const bool mirrored : {false, true}) {
      std::vector<Vec3d> positions;
      for (const auto& [u, v] : {std::pair{0.F, 0.F}, {4.F, 0.F}, {1.F, 1.F}, {0.F, 4.F}}) {  // a dart
        Vec3d p{};
        p[(axis + 1) % 3] = mirrored ? v : u;
        p[(axis + 2) % 3] = mirrored ? u : v;
        positions.push_back(p);
      }
      std::vector<Triangle> triangles;
      Triangulate(std::array<uint32_t, 4>{0, 1, 2, 3}, positions, triangles);
      ASSERT_EQ(triangles.size(), 2u);
      for (const Triangle& t : triangles) {  // the cut must be 0-2
        EXPECT_TRUE(std::count(t.begin(), t.end(), 0u) == 1 && std::count(t.begin(), t.end(), 2u) == 1);
      }
    }
  }
}

double AreaOf(const std::vector<Triangle>& triangles, const std::vector<Vec3d>& positions) {
  double sum = 0;
  for (const auto& [a, b, c] : triangles) {
    const Vec3d &p = positions[a], &q = positions[b], &r = positions[c];
    const double twice = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    EXPECT_GT(twice, 0);
    sum += twice / 2;
  }
  return sum;
}

// An arc of a band: half of its corners are reflex, and no fan covers it. A search of all corners for each ear takes
// minutes here.
TEST(Polygon, APolygonOfManyReflexCornersIsCutIntoTrianglesOfItsArea) {
  constexpr uint32_t kSide = 8000;
  std::vector<Vec3d> positions;
  std::vector<uint32_t> polygon;
  double area = 0;
  for (uint32_t n = 0; n < 2 * kSide; ++n) {
    const bool outer = n < kSide;
    const double angle = 3.0 * (outer ? n : 2 * kSide - 1 - n) / kSide, radius = outer ? 2 : 1.9;
    positions.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
    polygon.push_back(n);
  }
  for (uint32_t n = 0; n < 2 * kSide; ++n) {
    const Vec3d &p = positions[n], &q = positions[(n + 1) % (2 * kSide)];
    area += (p[0] * q[1] - q[0] * p[1]) / 2;
  }
  std::vector<Triangle> triangles;
  Triangulate(polygon, positions, triangles);
  EXPECT_EQ(triangles.size(), 2 * kSide - 2);
  EXPECT_NEAR(AreaOf(triangles, positions), area, 1e-9);
}

TEST(Polygon, AHoleJoinedToTheRimStaysAHole) {
  const std::vector<Vec3d> positions = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0},
                                        {1, 1, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}};
  std::vector<Triangle> triangles;
  Triangulate(std::array<uint32_t, 10>{0, 1, 2, 3, 0, 4, 5, 6, 7, 4}, positions, triangles);
  EXPECT_EQ(triangles.size(), 8u);
  EXPECT_EQ(AreaOf(triangles, positions), 12);
}

TEST(Polygon, PolygonsWithoutAreaKeepAllTheirCorners) {
  std::vector<Triangle> triangles;
  Triangulate(std::array<uint32_t, 5>{0, 1, 2, 3, 4}, std::vector<Vec3d>(5), triangles);
  EXPECT_EQ(triangles.size(), 3u);
}

}  // namespace
}  // namespace latvox::client
