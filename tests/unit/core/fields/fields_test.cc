// Fields of voxels, compared with rational distances to all triangles.
#include "core/request/fields.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "core/band/metric.h"
#include "core/digitize/crossing.h"
#include "core/snap/snap.h"
#include "core/voxelizer/voxelizer.h"
#include "tests/unit/core/distance.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/fields.h"
#include "tests/unit/core/fields/field_oracle.h"
#include "tests/unit/core/solid/line_fill.h"
#include "tests/unit/core/sphere.h"
#include "tests/unit/dose.h"

namespace latvox {
namespace {

using testing::HasSubstr;
using Carried = std::map<Vec3i, VoxelFields>;

constexpr FieldList kAll{Field::kPart,     Field::kMaterial, Field::kColor, Field::kDistance,
                         Field::kTriangle, Field::kPoint,    Field::kNormal};

Carried CarriedBy(const Result& result, const FieldList& fields) { return FieldsByVoxel(result.tiles, fields); }

// Whether no other float lies between the value and the exact one.
void ExpectNextTo(float value, long double exact) {
  EXPECT_LT(std::nextafter(value, -INFINITY), exact * (1 + 1e-15L) + 1e-30L);
  EXPECT_GT(std::nextafter(value, INFINITY), exact * (1 - 1e-15L) - 1e-30L);
}

void ExpectNormal(const std::array<float, 3>& normal, const Triangle& corners, const Lattice& lattice) {
  if (!FieldOracle::HasArea(corners)) {
    EXPECT_EQ(normal, (std::array<float, 3>{}));
    return;
  }
  std::array<std::array<long double, 3>, 2> edges{};
  for (size_t edge = 0; edge < 2; ++edge) {
    for (size_t c = 0; c < 3; ++c) {
      const long double steps = corners[edge + 1][c] - corners[0][c];
      for (size_t m = 0; m < 3; ++m) edges[edge][m] += steps * static_cast<long double>(lattice.basis()[c][m]);
    }
  }
  const auto& [e, f] = edges;
  const std::array<long double, 3> cross{e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2],
                                         e[0] * f[1] - e[1] * f[0]};
  const long double length = std::sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]);
  for (size_t m = 0; m < 3; ++m) {
    EXPECT_NEAR(static_cast<double>(normal[m]), static_cast<double>(cross[m] / length), 0x1p-24);
    EXPECT_FALSE(normal[m] == 0 && std::signbit(normal[m]));
  }
}

// `found`: for kAll.
void ExpectVoxel(const VoxelFields& found, const FieldAnswer& answer, const FieldOracle& oracle,
                 const Lattice& lattice) {
  EXPECT_EQ(NumbersOf<uint32_t>(found[0])[0], answer.numbers[0]);
  EXPECT_EQ(NumbersOf<uint32_t>(found[1])[0], answer.numbers[1]);
  const auto color = NumbersOf<uint8_t, 3>(found[2]);
  EXPECT_EQ(color[0] << 16 | color[1] << 8 | color[2], answer.numbers[2]);
  const float distance = NumbersOf<float>(found[3])[0];
  const double one = MakeMetric(lattice).value().one;
  ExpectNextTo(std::abs(distance), std::sqrt(answer.square.convert_to<long double>() / one) *
                                       static_cast<long double>(lattice.voxel_size() / kLatticeUnit));
  EXPECT_EQ(distance == 0, answer.square == 0);
  EXPECT_EQ(NumbersOf<uint32_t>(found[4])[0], answer.triangle);
  const auto weights = NumbersOf<float, 2>(found[5]);
  for (size_t n = 0; n < 2; ++n) {
    EXPECT_TRUE(weights[n] >= 0 && weights[n] <= 1 && !std::signbit(weights[n])) << weights[n];
    if (answer.weights) ExpectNextTo(weights[n], (*answer.weights)[n + 1].convert_to<long double>());
  }
  ExpectNormal(NumbersOf<float, 3>(found[6]), oracle.CornersOf(answer.triangle), lattice);
}

void SetRandomNumbers(uint32_t count, uint32_t below, std::mt19937& random, TriangleMesh& mesh) {
  mesh.attributes.resize(mesh.vertices.size() * count);
  for (uint32_t& value : mesh.attributes) value = static_cast<uint32_t>(random() % below);
}

oracle::Int3 RandomCorner(int64_t step, std::mt19937& random) {
  oracle::Int3 corner;
  for (int64_t& x : corner) x = static_cast<int64_t>(random() % (5 * 256)) / step * step;
  return corner;
}

// Triangles whose corners are multiples of `step` / 256 voxels, some without area, and a sliver.
TriangleMesh Soup(size_t triangles, int64_t step, const Lattice& lattice, std::mt19937& random) {
  oracle::Mesh mesh(triangles);
  for (oracle::Triangle& triangle : mesh) {
    for (oracle::Int3& corner : triangle) corner = RandomCorner(step, random);
  }
  mesh.insert(mesh.begin(), {mesh[0][0], mesh[0][1], mesh[0][0]});
  mesh.push_back({mesh[1][2], mesh[1][2], mesh[1][2]});
  mesh.push_back({oracle::Int3{0, 0, 0}, oracle::Int3{765, 766, 767}, oracle::Int3{382, 383, 384}});
  return ToWorld(mesh, lattice, {62, -3, 61});
}

// Closed bodies, which overlap.
TriangleMesh Tetrahedra(size_t count, int64_t step, const Lattice& lattice, std::mt19937& random) {
  oracle::Mesh mesh;
  for (size_t n = 0; n < count; ++n) {
    std::array<oracle::Int3, 4> v;
    for (oracle::Int3& corner : v) corner = RandomCorner(step, random);
    for (const auto& [a, b, c] : {std::array<size_t, 3>{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}) {
      mesh.push_back({v[a], v[b], v[c]});
    }
  }
  return ToWorld(mesh, lattice, {62, -3, 61});
}

// Returns how many of the voxels were tied.
size_t ExpectExact(const TriangleMesh& mesh, const Lattice& lattice, VoxelizeOptions options) {
  options.fields = kAll;
  const Result result = Voxelize(mesh, Unscaled(lattice), options);
  const FieldOracle oracle(mesh, lattice, 3);
  size_t tied = 0;
  const Carried carried = CarriedBy(result, kAll);
  EXPECT_EQ(carried.size(), result.totals.voxels);
  EXPECT_FALSE(carried.empty());
  for (const auto& [ijk, found] : carried) {
    SCOPED_TRACE(testing::Message() << ijk[0] << ' ' << ijk[1] << ' ' << ijk[2]);
    const FieldAnswer answer = oracle.At(ijk);
    ExpectVoxel(found, answer, oracle, lattice);
    tied += answer.tied ? 1 : 0;
  }
  return tied;
}

TEST(Fields, AreThoseOfTheNearestTriangleForSetsOfOpenMeshes) {
  std::mt19937 random(5);
  size_t tied = 0, n = 0;
  for (const Lattice& lattice : Lattices()) {
    const Connected outside{.seed = Apply(lattice.basis(), Vec3d{60, -5, 59}), .allow_outside = true};
    for (const SetOption& set :
         {SetOption{SeparatingSurface{}}, SetOption{SupercoverSurface{}}, SetOption{Band{1.5, true}},
          SetOption{Links{}}, SetOption{Enclosed{}}, SetOption{outside}}) {
      VoxelizeOptions options{.set = set};
      if (!std::holds_alternative<Band>(set)) options.separability = static_cast<int>(n / 3 % 3);
      const int64_t step = n % 2 == 0 ? 1 : 128;
      SCOPED_TRACE(testing::Message() << lattice.name() << " step " << step << " job " << n++);
      TriangleMesh mesh = Soup(10, step, lattice, random);
      SetRandomNumbers(3, 50, random, mesh);
      tied += ExpectExact(mesh, lattice, options);
    }
  }
  EXPECT_GT(tied, Dose(25U, 5U));
}

TEST(Fields, AreThoseOfTheNearestTriangleForSetsOfClosedMeshes) {
  std::mt19937 random(6);
  size_t tied = 0, n = 0;
  for (const Lattice& lattice : Lattices()) {
    const InteriorRule rule = n % 2 == 0 ? InteriorRule::kParity : InteriorRule::kAuto;
    for (const SetOption& set :
         {SetOption{Solid{rule, SolidSurface::kSeparating}}, SetOption{Solid{rule, SolidSurface::kSupercover}},
          SetOption{Solid{rule, SolidSurface::kNone}}, SetOption{Links{LinkSide::kInside}},
          SetOption{Links{LinkSide::kOutside}}}) {
      const int64_t step = n % 2 == 0 ? 1 : 256;
      SCOPED_TRACE(testing::Message() << lattice.name() << " step " << step << " job " << n++);
      TriangleMesh mesh = Tetrahedra(4, step, lattice, random);
      SetRandomNumbers(3, 50, random, mesh);
      tied += ExpectExact(mesh, lattice, {.set = set});
    }
    TriangleMesh box = ToWorld(Box({3, 5, 7}, {1283, 1279, 1290}), lattice, {62, -3, 61});
    SetRandomNumbers(3, 50, random, box);
    tied += ExpectExact(box, lattice, {.set = Enclosed{SolidSurface::kNone}});
  }
  EXPECT_GT(tied, Dose(100U, 50U));
}

// A box with faces on lattice points, made of separate vertices. Points inside are equally far from several faces.
TEST(Fields, OfTiesAreTheLeast) {
  for (const NamedLattice name : {NamedLattice::kCartesian, NamedLattice::kBcc}) {
    const Lattice lattice = Lattice::Named(name);
    TriangleMesh mesh;
    for (uint32_t face = 0; face < 6; ++face) {
      const auto first = static_cast<uint32_t>(mesh.vertices.size());
      const size_t axis = face / 2;
      for (uint32_t corner = 0; corner < 4; ++corner) {
        Vec3f& v = mesh.vertices.emplace_back();
        v[axis] = face % 2 == 0 ? 0 : 4;
        v[(axis + 1) % 3] = corner % 2 == 0 ? 0 : 4;
        v[(axis + 2) % 3] = corner < 2 ? 0 : 4;
        mesh.attributes.insert(mesh.attributes.end(), {7 - face, face, face});
      }
      mesh.triangles.push_back({first, first + 1, first + 3});
      mesh.triangles.push_back({first, first + 3, first + 2});
    }
    EXPECT_GT(ExpectExact(mesh, lattice, {.minimal = false}), 10U);
    EXPECT_GT(ExpectExact(mesh, lattice, {.set = Solid{.rule = InteriorRule::kParity}}), 10U);
    // (0, 0, 0) is on the faces 0, 2 and 4.
    const Result result = Voxelize(mesh, Unscaled(lattice), {.minimal = false, .fields = kAll});
    const VoxelFields corner = CarriedBy(result, kAll).at({0, 0, 0});
    EXPECT_EQ(NumbersOf<uint32_t>(corner[0])[0], 3U);
    EXPECT_EQ(NumbersOf<uint32_t>(corner[1])[0], 0U);
    EXPECT_EQ(NumbersOf<uint32_t>(corner[4])[0], 0U);
  }
}

// A triangle without area comes first, at the same place as an edge of another one. A voxel is nearest to both.
TEST(Fields, PreferATriangleWithAnAreaToOneWithout) {
  const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {6, 0, 0}, {0, 6, 0}};
  mesh.triangles = {{0, 1, 0}, {0, 1, 2}, {2, 2, 2}};
  const Result result = Voxelize(mesh, Unscaled(lattice), {.set = Band{1.2, true}, .fields = {Field::kTriangle}});
  const Carried carried = CarriedBy(result, {Field::kTriangle});
  EXPECT_GT(carried.size(), 50U);
  for (const auto& [ijk, found] : carried)
    EXPECT_EQ(NumbersOf<uint32_t>(found[0])[0], 1U) << ijk[0] << ijk[1] << ijk[2];
  // Alone, it is the nearest.
  mesh.triangles = {{0, 1, 0}, {2, 2, 2}};
  for (const auto& [ijk, found] : CarriedBy(
           Voxelize(mesh, Unscaled(lattice), {.set = Band{1.2, true}, .fields = {Field::kTriangle, Field::kNormal}}),
           {Field::kTriangle, Field::kNormal})) {
    EXPECT_EQ(NumbersOf<uint32_t>(found[0])[0], ijk[1] > 3 ? 1U : 0U);
    EXPECT_EQ((NumbersOf<float, 3>(found[1])), (std::array<float, 3>{}));
  }
}

// Copies of a triangle are at the same distance, so the smallest of their numbers counts.
TEST(Fields, OfManyTrianglesInOnePlace) {
  constexpr uint32_t kCopies = 900;
  const FieldList fields{Field::kPart, Field::kMaterial};
  std::mt19937 random(11);
  const Lattice lattice = Lattice::Named(NamedLattice::kBcc);
  const oracle::Int3 a{0, 0, 0}, b{4500, 700, 300}, c{1200, 4800, 900}, d{4600, 4700, 2048};
  TriangleMesh once = ToWorld({{a, b, c}, {b, d, c}}, lattice, {6, 6, 6});
  once.attributes.assign(once.vertices.size() * 2, 1U << 30);
  TriangleMesh many;
  for (uint32_t copy = 0; copy < kCopies; ++copy) {
    for (auto triangle : once.triangles) {
      for (uint32_t& vertex : triangle) {
        for (uint32_t n = 0; n < 2; ++n) {
          many.attributes.push_back(static_cast<uint32_t>(random() % 1000000));
          once.attributes[2 * vertex + n] = std::min(once.attributes[2 * vertex + n], many.attributes.back());
        }
        many.vertices.push_back(once.vertices[vertex]);
        vertex = static_cast<uint32_t>(many.vertices.size() - 1);
      }
      many.triangles.push_back(triangle);
    }
  }
  std::shuffle(many.triangles.begin(), many.triangles.end(), random);
  const VoxelizeOptions options{.minimal = false, .fields = fields};
  EXPECT_EQ(CarriedBy(Voxelize(many, Unscaled(lattice), options), fields),
            CarriedBy(Voxelize(once, Unscaled(lattice), options), fields));
}

// There are so many triangles that a job without fields would leave out those that meet no lattice line.
TEST(Fields, OfTrianglesFarSmallerThanVoxels) {
  std::mt19937 random(7);
  TriangleMesh mesh = Sphere(64, 2.3F);
  SetRandomNumbers(3, 1000, random, mesh);
  ExpectExact(mesh, Lattice::Named(NamedLattice::kFcc), {});
}

// Inside: on the other side of the mesh than the outside, whatever the set.
TEST(Fields, HaveNegativeDistancesInside) {
  const TriangleMesh mesh = Sphere(16, 21);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kBcc));
  const auto inside = VoxelsOf(Voxelize(mesh, grid, {.set = Solid{.surface = SolidSurface::kNone}}));
  for (const SetOption& set : {SetOption{SeparatingSurface{}}, SetOption{SupercoverSurface{}}, SetOption{Band{3, true}},
                               SetOption{Solid{}}, SetOption{Solid{.surface = SolidSurface::kNone}}}) {
    size_t negative = 0;
    const Result result = Voxelize(mesh, grid, {.set = set, .fields = {Field::kDistance}, .signed_distance = true});
    for (const auto& [ijk, distance] : DistancesOf(result.tiles)) {
      const bool is_inside = inside.contains({ijk[0], ijk[1], ijk[2]});
      EXPECT_EQ(distance < 0, is_inside && distance != 0) << set.index();
      negative += distance < 0;
    }
    EXPECT_GT(negative, 100U) << set.index();
  }
}

TEST(Fields, OfPartsAddUp) {
  const FieldList fields{Field::kPart, Field::kDistance, Field::kNormal};
  std::mt19937 random(9);
  TriangleMesh mesh = Sphere(20, 30);
  SetRandomNumbers(1, 1000, random, mesh);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kBcc));
  for (const SetOption& set : {SetOption{SeparatingSurface{}}, SetOption{Band{2, true}}, SetOption{Solid{}}}) {
    SCOPED_TRACE(set.index());
    const VoxelizeOptions options{.set = set, .fields = fields};
    const Result whole = Voxelize(mesh, grid, options);
    const Carried carried = CarriedBy(whole, fields);
    EXPECT_EQ(whole.totals.digest, Voxelize(mesh, grid, {.set = set}).totals.digest);

    std::vector<Digest> sum(fields.size());
    Carried joined;
    for (uint32_t index = 0; index < 3; ++index) {
      VoxelizeOptions shard = options;
      shard.shard = Shard{index, 3};
      const Result part = Voxelize(mesh, grid, shard);
      for (size_t n = 0; n < part.totals.fields.size(); ++n) sum[n].Add(part.totals.fields[n]);
      joined.merge(CarriedBy(part, fields));
    }
    EXPECT_EQ(sum, whole.totals.fields);
    EXPECT_EQ(joined, carried);

    VoxelizeOptions cut = options;
    cut.region = IndexBox{{-15, -3, 4}, {17, 35, 21}};
    Carried in_region;
    std::copy_if(carried.begin(), carried.end(), std::inserter(in_region, in_region.end()),
                 [&](const auto& voxel) { return cut.region->Contains(voxel.first); });
    EXPECT_EQ(CarriedBy(Voxelize(mesh, grid, cut), fields), in_region);

    cut = options;
    cut.bounds = Bounds{{-10, -15, -5}, {25, 21, 11}};
    Carried in_bounds;
    std::copy_if(carried.begin(), carried.end(), std::inserter(in_bounds, in_bounds.end()), [&](const auto& voxel) {
      const Vec3d center = Apply(grid.lattice.basis(), ToDouble(voxel.first));
      bool inside = true;
      for (size_t m = 0; m < 3; ++m) inside &= cut.bounds->min[m] <= center[m] && center[m] <= cut.bounds->max[m];
      return inside;
    });
    EXPECT_EQ(CarriedBy(Voxelize(mesh, grid, cut), fields), in_bounds);

    const size_t half = whole.tiles.size() / 2;
    cut = options;
    cut.resume_after = whole.tiles[half].tile_ijk;
    const Result rest = Voxelize(mesh, grid, cut);
    ASSERT_EQ(rest.tiles.size(), whole.tiles.size() - half - 1);
    EXPECT_EQ(rest.tiles.front().fields, whole.tiles[half + 1].fields);
  }
}

TEST(Fields, AreTheSameForAnyThreadsAndOrder) {
  std::mt19937 random(9);
  TriangleMesh mesh = Sphere(20, 30);
  SetRandomNumbers(1, 1000, random, mesh);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kBcc));
  TriangleMesh plain = mesh;
  plain.attributes.clear();
  for (const SetOption& set : {SetOption{SeparatingSurface{}}, SetOption{Band{2, true}}, SetOption{Solid{}}}) {
    const VoxelizeOptions options{.set = set, .fields = {Field::kTriangle, Field::kPoint}};
    EXPECT_EQ(Voxelize(plain, grid, options, 1).totals.fields, Voxelize(plain, grid, options, 3).totals.fields);
  }
  // The part and the distance do not depend on the order of triangles and corners.
  const VoxelizeOptions options{.fields = {Field::kPart, Field::kDistance}};
  const auto before = Voxelize(mesh, grid, options).totals.fields;
  std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
  for (auto& triangle : mesh.triangles) std::rotate(triangle.begin(), triangle.begin() + random() % 3, triangle.end());
  EXPECT_EQ(Voxelize(mesh, grid, options, 1).totals.fields, before);
  ++mesh.attributes[mesh.triangles[0][0]];
  EXPECT_NE(Voxelize(mesh, grid, options).totals.fields, before);
}

TEST(Fields, AreTheSameForAllKernels) {
  const TriangleMesh mesh = Sphere(40, 30);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kFcc));
  const VoxelizeOptions options{.set = Solid{}, .fields = {Field::kDistance, Field::kTriangle, Field::kPoint}};
  std::optional<std::vector<Digest>> expected;
  for (const Simd simd : SimdHere()) {
    const ForcedSimd forced(simd);
    const auto found = Voxelize(mesh, grid, options).totals.fields;
    EXPECT_EQ(found, expected.value_or(found));
    expected = found;
  }
}

TEST(Fields, AreRefusedWhereTheyMeanNothing) {
  TriangleMesh mesh = Sphere(4, 10);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  const auto refusal = [&](const VoxelizeOptions& options) {
    const auto job = VoxelizeJob::Create(mesh, grid, options);
    EXPECT_EQ(job.status().code(), absl::StatusCode::kInvalidArgument);
    return std::string(job.status().message());
  };
  EXPECT_THAT(refusal({.fields = {Field::kPart}}), HasSubstr("fields: the mesh has 0 numbers for 128 vertices, not 1"));
  EXPECT_THAT(refusal({.algorithm = Algorithm::kBruteForce, .fields = {Field::kNormal}}), HasSubstr("brute-force"));
  mesh.triangles.pop_back();
  EXPECT_THAT(refusal({.fields = {Field::kDistance}, .signed_distance = true}), HasSubstr("closed"));
  const Grid tiny{Lattice::Named(NamedLattice::kCartesian).Scaled(1e-30).value(), {0, 0, 0}};
  const auto job = VoxelizeJob::Create(mesh, tiny, {.fields = {Field::kDistance}});
  EXPECT_THAT(std::string(job.status().message()),
              testing::AnyOf(HasSubstr("fields: for distances"), HasSubstr("extent")));
}

}  // namespace
}  // namespace latvox
