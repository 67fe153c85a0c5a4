// Fractions, compared with all finer points one by one.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "core/lattice/cell_points.h"
#include "core/lattice/integer_cell.h"
#include "core/voxelizer/voxelizer.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/fields.h"
#include "tests/unit/core/fields/fraction_oracle.h"
#include "tests/unit/core/fields/shards.h"
#include "tests/unit/core/solid/line_fill.h"
#include "tests/unit/core/sphere.h"
#include "tests/unit/dose.h"

namespace latvox {
namespace {

constexpr InteriorRule kRules[] = {InteriorRule::kParity, InteriorRule::kWinding, InteriorRule::kPositive};
constexpr FieldList kFraction{Field::kFraction};
constexpr Solid kInterior{.surface = SolidSurface::kNone};

std::map<Int3, int64_t> FractionsOf(const Result& result, const FieldList& fields = kFraction,
                                    const Vec3i& shift = {}) {
  const auto place = static_cast<size_t>(std::ranges::find(fields, Field::kFraction) - fields.begin());
  std::map<Int3, int64_t> fractions;
  for (const auto& [ijk, of_voxel] : FieldsByVoxel(result.tiles, fields)) {
    fractions[ToOracle(ijk - shift)] = NumbersOf<uint16_t>(of_voxel[place])[0];
  }
  return fractions;
}

int64_t SumOf(const std::map<Int3, int64_t>& fractions) {
  int64_t sum = 0;
  for (const auto& [z, fraction] : fractions) sum += fraction;
  return sum;
}

class FractionOnLattice : public testing::TestWithParam<FormedLattice> {};

INSTANTIATE_TEST_SUITE_P(Exact, FractionOnLattice, testing::ValuesIn(FormedLattices()),
                         [](const auto& lattice) { return lattice.param.name; });

TEST_P(FractionOnLattice, CountsThePointsThatACellOwns) {
  const IntegerCell cell = *IntegerCell::Of(GetParam().lattice);
  for (const int32_t n : {1, 2, 3, 8, 16}) {
    const OwnerOracle owners(GetParam().form, n);
    const CellPoints points = PointsOf(cell, n);
    std::set<Int3> rests;
    for (const CellPoints::Run& run : points.runs) {
      EXPECT_LE(run.count, n);
      for (int32_t k = 0; k < run.count; ++k) {
        const Vec3i point = run.first + Vec3i{0, 0, k};
        ASSERT_EQ(owners.OwnerOf(ToOracle(point)), (Int3{0, 0, 0}));
        Int3 rest;
        for (size_t m = 0; m < 3; ++m) {
          EXPECT_TRUE(points.low[m] <= point[m] && point[m] <= points.high[m]);
          rest[m] = ((point[m] % n) + n) % n;
        }
        rests.insert(rest);
      }
    }
    EXPECT_EQ(rests.size(), static_cast<size_t>(points.size()));
  }
}

// Tetrahedra that overlap, touch, and are inside out, on and off finer points, and a box inside of a box.
std::vector<oracle::Mesh> Bodies(int64_t n) {
  std::vector<oracle::Mesh> meshes;
  std::mt19937 random(static_cast<uint32_t>(n));
  const int64_t most = n > 4 ? 2 * 256 : 5 * 256;
  for (const int64_t grain : {256 / n, int64_t{128}, int64_t{1}}) {
    std::uniform_int_distribution<int64_t> coordinate(0, most / grain);
    oracle::Mesh mesh;
    for (int body = 0; body < 3; ++body) {
      std::array<Int3, 4> v;
      for (Int3& p : v) p = {coordinate(random) * grain, coordinate(random) * grain, coordinate(random) * grain};
      AddTetrahedron(v, body == 2, mesh);
    }
    meshes.push_back(mesh);
  }
  oracle::Mesh nested = Box({0, 0, 0}, {most, most, most});
  const oracle::Mesh inner = Box({128, 64, 256}, {most - 128, most, most - 64});
  nested.insert(nested.end(), inner.begin(), inner.end());
  meshes.push_back(nested);
  return meshes;
}

// Each voxel with a fraction is in the solid with its supercover, because its cell meets the mesh or is inside.
TEST_P(FractionOnLattice, IsThatOfTheOracle) {
  const Lattice& lattice = GetParam().lattice;
  size_t between = 0, number = 0;
  for (const uint32_t n : {2U, 3U, 8U}) {
    const OwnerOracle owners(GetParam().form, n);
    for (const oracle::Mesh& mesh : Bodies(n)) {
      const InteriorRule rule = kRules[number++ % 3];
      const std::map<Int3, int64_t> expected = FractionsOf(mesh, owners, n, rule);
      for (const Vec3i& shift : {Vec3i{0, 0, 0}, Vec3i{62, -67, 63}}) {
        SCOPED_TRACE(testing::Message() << n << ' ' << NameOf(rule) << ' ' << shift[0]);
        const VoxelizeOptions options{
            .set = Solid{rule, SolidSurface::kSupercover}, .fields = kFraction, .fraction_n = n};
        const auto found =
            FractionsOf(Voxelize(ToWorld(mesh, lattice, shift), Unscaled(lattice), options), kFraction, shift);
        std::map<Int3, int64_t> others = found;
        std::erase_if(others, [](const auto& of_voxel) { return of_voxel.second == 0; });
        ASSERT_EQ(others, expected);
        between += static_cast<size_t>(
            std::ranges::count_if(expected, [&](const auto& z) { return z.second < int64_t{n} * n * n; }));
      }
    }
  }
  EXPECT_GT(between, 300U);
}

// The core's solid of the finer lattice, over many tiles. Triangles are tiny, or as large as tiles.
TEST_P(FractionOnLattice, IsThatOfASolidOnTheFinerLattice) {
  const Lattice& lattice = GetParam().lattice;
  for (const int rings : {5, 100}) {
    const uint32_t n = rings == 5 ? 7 : 4;
    oracle::Mesh mesh, finer;
    const TriangleMesh sphere = Sphere(rings, 8);
    for (const auto& indices : sphere.triangles) {
      oracle::Triangle triangle;
      for (size_t c = 0; c < 3; ++c) {
        for (size_t m = 0; m < 3; ++m) triangle[c][m] = std::llround(sphere.vertices[indices[c]][m] * 256);
      }
      mesh.push_back(triangle);
      for (Int3& v : triangle) {
        for (int64_t& x : v) x *= n;
      }
      finer.push_back(triangle);
    }
    const OwnerOracle owners(GetParam().form, n);
    const auto points = VoxelsOf(Voxelize(ToWorld(finer, lattice), Unscaled(lattice), {.set = kInterior}));
    std::map<Int3, int64_t> expected;
    for (const Int3& point : points) ++expected[owners.OwnerOf(point)];
    const VoxelizeOptions options{
        .set = Solid{.surface = SolidSurface::kSupercover}, .fields = kFraction, .fraction_n = n};
    auto found = FractionsOf(Voxelize(ToWorld(mesh, lattice), Unscaled(lattice), options));
    EXPECT_GT(found.size(), expected.size());
    std::erase_if(found, [](const auto& of_voxel) { return of_voxel.second == 0; });
    EXPECT_EQ(found, expected);
  }
}

// Faces are on finer points, also halfway between voxels. The shift makes cells and boxes half open in the same way.
TEST_P(FractionOnLattice, OfABoxSumsUpToItsVolume) {
  const Lattice& lattice = GetParam().lattice;
  for (const uint32_t n : {2U, 4U, 8U, 16U}) {
    const int64_t step = 256 / n;
    const oracle::Mesh box = Box({-3 * step, 5 * step, 0}, {40 * step, 38 * step, 17 * step});
    const VoxelizeOptions options{
        .set = Solid{.surface = SolidSurface::kSupercover}, .fields = kFraction, .fraction_n = n};
    EXPECT_EQ(SumOf(FractionsOf(Voxelize(ToWorld(box, lattice), Unscaled(lattice), options))), 43 * 33 * 17);
  }
}

TEST(Fraction, OfABoxAlongACellIsFullThereAlone) {
  const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  const oracle::Mesh box = Box({-128, -128, -128}, {128, 128, 128});
  for (const uint32_t n : {2U, 3U, 8U, 16U}) {
    const VoxelizeOptions options{.set = SupercoverSurface{}, .fields = kFraction, .fraction_n = n};
    for (const auto& [z, fraction] : FractionsOf(Voxelize(ToWorld(box, lattice), Unscaled(lattice), options))) {
      EXPECT_EQ(fraction, z == Int3{} ? int64_t{n} * n * n : 0);
    }
  }
}

TEST(Fraction, IsAFieldOfEverySet) {
  const TriangleMesh mesh = Sphere(20, 9);
  for (const NamedLattice name :
       Dose<std::vector<NamedLattice>>({NamedLattice::kCartesian, NamedLattice::kBcc}, {NamedLattice::kBcc})) {
    const Grid grid = Unscaled(Lattice::Named(name));
    const auto all = FractionsOf(Voxelize(mesh, grid, {.set = Band{14, true}, .fields = kFraction, .fraction_n = 5}));
    for (const SetOption& set :
         {SetOption{SeparatingSurface{}}, SetOption{SupercoverSurface{}}, SetOption{Solid{}}, SetOption{kInterior},
          SetOption{Solid{.rule = InteriorRule::kParity, .surface = SolidSurface::kSupercover}},
          SetOption{Band{1.5, true}}, SetOption{Links{}}, SetOption{Links{LinkSide::kInside}}, SetOption{Enclosed{}},
          SetOption{Connected{{0, 0, 0}, 0, false}}, SetOption{Connected{{0, 0, 0}, 1.7, false}}}) {
      SCOPED_TRACE(set.index());
      // With other fields before and after it, and with signs.
      const FieldList fields{Field::kTriangle, Field::kFraction, Field::kDistance};
      const VoxelizeOptions options{.set = set, .fields = fields, .signed_distance = true, .fraction_n = 5};
      const auto found = FractionsOf(Voxelize(mesh, grid, options), fields);
      EXPECT_GT(found.size(), 500U);
      size_t wrong = 0;
      for (const auto& [z, fraction] : found) wrong += all.at(z) != fraction ? 1 : 0;
      EXPECT_EQ(wrong, 0U);
    }
  }
}

TEST(Fraction, OfPartsIsThatOfTheWhole) {
  const TriangleMesh mesh = Sphere(60, 45);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kFcc));
  const VoxelizeOptions whole{.set = Solid{}, .fields = kFraction, .fraction_n = 3};
  const Result all = Voxelize(mesh, grid, whole);
  ExpectPartsAddUp(mesh, grid, whole, all);
  VoxelizeOptions some = whole;
  some.region = IndexBox{{-7, -70, 5}, {40, 3, 69}};
  const auto fractions = FractionsOf(all), found = FractionsOf(Voxelize(mesh, grid, some));
  EXPECT_GT(found.size(), 5000U);
  for (const auto& [z, fraction] : found) ASSERT_EQ(fractions.at(z), fraction);
}

TEST(Fraction, DoesNotDependOnKernelsThreadsOrTheOrderOfTriangles) {
  TriangleMesh mesh = Sphere(60, 10);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kHexagonal));
  const VoxelizeOptions options{.fields = kFraction, .fraction_n = 8};
  const JobTotals expected = Voxelize(mesh, grid, options).totals;
  std::ranges::reverse(mesh.triangles);
  WithEachSimd([&] {
    for (const int threads : {1, 2}) EXPECT_EQ(Voxelize(mesh, grid, options, threads).totals.fields, expected.fields);
  });
}

// The polyhedron is smaller than the sphere by less than 0.4 %, and points differ from volumes by far less.
TEST(Fraction, OfASphereSumsUpToItsVolume) {
  TriangleMesh mesh = Sphere(50, 20);
  for (Vec3f& v : mesh.vertices) {
    const float length = std::sqrt(Dot(v, v));
    for (float& x : v) x *= 20 / length;
  }
  for (const NamedLattice name : {NamedLattice::kCartesian, NamedLattice::kBcc, NamedLattice::kFcc}) {
    const Grid grid = Unscaled(Lattice::Named(name));
    const VoxelizeOptions options{
        .set = Solid{.surface = SolidSurface::kSupercover}, .fields = kFraction, .fraction_n = 4};
    const double volume = static_cast<double>(SumOf(FractionsOf(Voxelize(mesh, grid, options)))) / 64;
    EXPECT_NEAR(volume / (4 * std::numbers::pi / 3 * 8000), 0.998, 0.002);
  }
}

TEST(Fraction, OfALabeledSolidIsThatOfAllLabelsTogether) {
  oracle::Mesh both = Box({-300, -300, -300}, {1800, 1800, 1800});
  const oracle::Mesh other = Box({900, 1000, 77}, {3000, 3100, 2000});
  both.insert(both.end(), other.begin(), other.end());
  for (const NamedLattice name : {NamedLattice::kCartesian, NamedLattice::kBcc}) {
    const Grid grid = Unscaled(Lattice::Named(name));
    TriangleMesh mesh = ToWorld(both, grid.lattice);
    const VoxelizeOptions plain{.set = Solid{.rule = InteriorRule::kWinding}, .fields = kFraction, .fraction_n = 6};
    const auto expected = FractionsOf(Voxelize(mesh, grid, plain));
    for (size_t v = 0; v < mesh.vertices.size(); ++v) mesh.attributes.push_back(v < 36 ? 3 : 4);
    VoxelizeOptions labeled = plain;
    labeled.set = Solid{.rule = InteriorRule::kWinding, .labels = Field::kPart};
    labeled.fields = {Field::kPart, Field::kFraction};
    const Result result = Voxelize(mesh, grid, labeled);
    EXPECT_EQ(FractionsOf(result, labeled.fields), expected);
    labeled.fields = {Field::kPart};
    labeled.fraction_n = 0;
    EXPECT_EQ(result.totals.fields[0], Voxelize(mesh, grid, labeled).totals.fields[0]);
  }
}

std::string RefusalOf(const TriangleMesh& mesh, const VoxelizeOptions& options) {
  const auto job = VoxelizeJob::Create(mesh, Unscaled(Lattice::Named(NamedLattice::kCartesian)), options);
  return std::string{(job.ok() ? (*job)->Prepare() : job.status()).message()};
}

TEST(Fraction, NeedsAClosedMesh) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {9, 0, 0}, {0, 9, 0}};
  mesh.triangles = {{0, 1, 2}};
  EXPECT_EQ(RefusalOf(mesh, {.fields = kFraction, .fraction_n = 4}),
            "mesh: it is not closed, which a fraction asks for");
  EXPECT_EQ(RefusalOf(mesh, {.set = Solid{}, .fields = kFraction, .fraction_n = 4}),
            "mesh: it is not closed, and 36 lattice lines along k end unbalanced; a fraction asks for a closed mesh");
}

TEST(Fraction, IsLimitedByTheExtentOfItsPoints) {
  const oracle::Mesh box = Box({0, 0, 0}, {256, 256, 256 * 8191});
  const TriangleMesh mesh = ToWorld(box, Lattice::Named(NamedLattice::kCartesian), {7, 0, 63});
  EXPECT_EQ(RefusalOf(mesh, {.fields = kFraction, .fraction_n = 16}), "");
  const oracle::Mesh longer = Box({0, 0, 0}, {256, 256, 256 * 8192});
  EXPECT_EQ(
      RefusalOf(ToWorld(longer, Lattice::Named(NamedLattice::kCartesian)), {.fields = kFraction, .fraction_n = 16}),
      "fraction_n: with 16 points along each axis of a cell, the mesh extends over 131073 points on lattice axis "
      "k, the limit is 131072");
}

}  // namespace
}  // namespace latvox
