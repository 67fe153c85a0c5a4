// Numbers of the mesh alone, which mostly need no nearest triangle, are those beside a field that needs it.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "core/request/fields.h"
#include "core/voxelizer/voxelizer.h"
#include "tests/unit/core/distance.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/fields.h"
#include "tests/unit/core/fields/shards.h"
#include "tests/unit/core/sphere.h"
#include "tests/unit/dose.h"

namespace latvox {
namespace {

using Carried = std::map<Vec3i, VoxelFields>;

// Overlapping spheres, with triangles that are far smaller than voxels, about as large, and far larger.
constexpr std::array kRings{30, 12, 4};

TriangleMesh Spheres() {
  TriangleMesh mesh;
  float x = 0;
  for (const int rings : kRings) {
    TriangleMesh sphere = Sphere(rings, 5.9F);
    const auto first = static_cast<uint32_t>(mesh.vertices.size());
    for (const Vec3f& v : sphere.vertices) mesh.vertices.push_back({v[0] + x, v[1] + x / 3, v[2] - x / 7});
    for (const auto& [a, b, c] : sphere.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
    x += 4.7F;
  }
  return mesh;
}

// Gives each sphere a part of its own.
void LabelSpheres(TriangleMesh& mesh) {
  for (uint32_t sphere = 0; sphere < kRings.size(); ++sphere) {
    const auto quads = static_cast<size_t>(2 * kRings[sphere] * kRings[sphere]);
    mesh.attributes.insert(mesh.attributes.end(), 4 * quads, (sphere + 1) % 3);
  }
  ASSERT_EQ(mesh.attributes.size(), mesh.vertices.size());
}

struct Numbering {
  std::string name;
  uint32_t fields;
  std::vector<uint32_t> numbers;
};

// Vertices come four to a quad, so most triangles have one number.
std::vector<Numbering> Numberings(const TriangleMesh& mesh) {
  std::mt19937 random(3);
  std::vector<Numbering> all{{"one part", 1, {}}, {"bodies", 1, {}}, {"many parts", 1, {}}, {"random", 2, {}}};
  for (uint32_t n = 0; n < mesh.vertices.size(); ++n) {
    all[0].numbers.push_back(5);
    all[1].numbers.push_back(mesh.vertices[n][0] < 5 ? 0 : 9);
    all[2].numbers.push_back(n / 4 % 101);
    all[3].numbers.push_back(static_cast<uint32_t>(random() % 3));
    all[3].numbers.push_back(static_cast<uint32_t>(random() % 2));
  }
  return all;
}

std::vector<VoxelizeOptions> Sets() {
  return {{.separability = 0}, {.separability = 1, .minimal = false},
          {.separability = 2}, {.set = SupercoverSurface{}},
          {.set = Links{}},    {.separability = 2, .set = Links{LinkSide::kInside}},
          {.set = Solid{}},    {.set = Band{1.5, true}}};
}

// The numbers of each voxel, from a job that also carries its nearest triangle: fields_test compares these with an
// oracle.
Carried BesideTriangles(const TriangleMesh& mesh, const Grid& grid, VoxelizeOptions options) {
  const size_t count = options.fields.size();
  options.fields.Add(Field::kTriangle);
  Carried carried = FieldsByVoxel(Voxelize(mesh, grid, options).tiles, options.fields);
  for (auto& [ijk, of_voxel] : carried) of_voxel.resize(count);
  return carried;
}

TEST(NumbersAlone, AreThoseOfTheNearestTriangle) {
  TriangleMesh mesh = Spheres();
  size_t job = 0;
  for (const Lattice& lattice : Lattices()) {
    const Grid grid = Unscaled(lattice);
    for (const Numbering& numbering : Numberings(mesh)) {
      mesh.attributes = numbering.numbers;
      size_t n = 0;
      for (VoxelizeOptions options : Sets()) {
        SCOPED_TRACE(testing::Message() << lattice.name() << ", " << numbering.name << ", set " << n++);
        if (job++ % Dose(1, 3) != 0) continue;
        options.fields = numbering.fields == 1 ? FieldList{Field::kPart} : FieldList{Field::kPart, Field::kMaterial};
        const Carried alone = FieldsByVoxel(Voxelize(mesh, grid, options).tiles, options.fields);
        EXPECT_GT(alone.size(), 10U);
        EXPECT_EQ(alone, BesideTriangles(mesh, grid, options));
      }
    }
  }
}

TEST(NumbersAlone, OfLabeledSolidsAreThoseOfTheNearestTriangle) {
  TriangleMesh mesh = Spheres();
  LabelSpheres(mesh);
  for (const Lattice& lattice : Lattices()) {
    const Grid grid = Unscaled(lattice);
    const VoxelizeOptions options{.set = Solid{.labels = Field::kPart}, .fields = {Field::kPart}};
    const Result result = Voxelize(mesh, grid, options);
    EXPECT_GT(result.totals.voxels, 30U) << lattice.name();
    EXPECT_EQ(FieldsByVoxel(result.tiles, options.fields), BesideTriangles(mesh, grid, options)) << lattice.name();
    ExpectPartsAddUp(mesh, grid, options, result);
  }
}

// The reach along one axis is many voxels there.
TEST(NumbersAlone, OnFlatLattices) {
  TriangleMesh mesh = Spheres();
  for (const double height : {0.2, 0.01}) {
    const Lattice lattice = *Lattice::FromBasis({Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, height}});
    for (const Numbering& numbering : Numberings(mesh)) {
      if (numbering.fields != 1) continue;
      mesh.attributes = numbering.numbers;
      const VoxelizeOptions options{.set = SupercoverSurface{}, .fields = {Field::kPart}};
      const Carried alone = FieldsByVoxel(Voxelize(mesh, Unscaled(lattice), options).tiles, options.fields);
      EXPECT_GT(alone.size(), 100U);
      EXPECT_EQ(alone, BesideTriangles(mesh, Unscaled(lattice), options)) << height << ' ' << numbering.name;
    }
  }
}

// A point inside of a label needs no search, and may be far from the mesh.
TEST(NumbersAlone, OfLabeledSolidsOnFlatLattices) {
  TriangleMesh mesh = Spheres();
  LabelSpheres(mesh);
  const Grid grid = Unscaled(*Lattice::FromBasis({Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 0.05}}));
  const VoxelizeOptions options{.set = Solid{.labels = Field::kPart}, .fields = {Field::kPart}};
  const Carried alone = FieldsByVoxel(Voxelize(mesh, grid, options).tiles, options.fields);
  EXPECT_GT(alone.size(), 1000U);
  EXPECT_EQ(alone, BesideTriangles(mesh, grid, options));
}

// Triangles that a tile's surface does not need may be the nearest to its voxels.
TEST(NumbersAlone, CountTrianglesThatMeetNoLatticeLine) {
  const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  TriangleMesh mesh = Sphere(64, 2.3F);
  std::mt19937 random(7);
  for (size_t n = 0; n < mesh.vertices.size(); ++n) mesh.attributes.push_back(static_cast<uint32_t>(random() % 1000));
  for (VoxelizeOptions options : Sets()) {
    options.fields = {Field::kPart};
    const Carried alone = FieldsByVoxel(Voxelize(mesh, Unscaled(lattice), options).tiles, options.fields);
    EXPECT_GT(alone.size(), 10U);
    EXPECT_EQ(alone, BesideTriangles(mesh, Unscaled(lattice), options));
  }
}

}  // namespace
}  // namespace latvox
