// Links and their fields, compared with rational shares of crossings that big integers find.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "core/fields/link_order.h"
#include "core/fields/link_share.h"
#include "core/request/fields.h"
#include "core/voxelizer/voxelizer.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/fields.h"
#include "tests/unit/core/fields/link_oracle.h"
#include "tests/unit/core/fields/links_parity.h"
#include "tests/unit/core/fields/shards.h"
#include "tests/unit/core/sphere.h"
#include "tests/unit/dose.h"

namespace latvox {
namespace {

using oracle::Int3;

constexpr FieldList kAll{Field::kLinkCrossings, Field::kLinks, Field::kLinkTriangles};

struct FoundLinks {
  std::vector<uint32_t> crossings;
  std::vector<float> shares;
  std::vector<uint32_t> triangles;
};

template <class T>
std::vector<T> NumbersIn(const std::vector<std::byte>& bytes) {
  std::vector<T> numbers(bytes.size() / sizeof(T));
  std::memcpy(numbers.data(), bytes.data(), bytes.size());
  return numbers;
}

// By voxel, moved back by `shift`. `result`: with kAll.
std::map<Int3, FoundLinks> LinksOf(const Result& result, size_t neighbors, const Vec3i& shift = {}) {
  std::map<Int3, FoundLinks> found;
  for (const auto& [ijk, fields] : FieldsByVoxel(result.tiles, kAll, neighbors)) {
    found[ToOracle(ijk - shift)] = {NumbersIn<uint32_t>(fields[0]), NumbersIn<float>(fields[1]),
                                    NumbersIn<uint32_t>(fields[2])};
  }
  return found;
}

void ExpectVoxel(const FoundLinks& found, const ExpectedLinks& expected, const std::vector<Vec3i>& neighbors) {
  size_t crossed = 0;
  for (size_t n = 0; n < neighbors.size(); ++n) {
    SCOPED_TRACE(testing::Message() << "neighbor " << n);
    const auto link = expected.find(ToOracle(neighbors[n]));
    if (link == expected.end()) {
      EXPECT_EQ(found.crossings[n], 0U);
      EXPECT_TRUE(std::isnan(found.shares[n]));
      EXPECT_EQ(found.triangles[n], kNoTriangle);
      continue;
    }
    ++crossed;
    EXPECT_EQ(found.crossings[n], link->second.crossings);
    EXPECT_TRUE(found.shares[n] > 0 && found.shares[n] <= 1) << found.shares[n];
    EXPECT_TRUE(StandsFor(found.shares[n], link->second.share)) << found.shares[n] << " for " << link->second.share;
    EXPECT_EQ(found.triangles[n], link->second.triangle);
  }
  EXPECT_EQ(crossed, expected.size());
}

std::optional<IndexBox> RegionOf(const std::optional<oracle::Box>& box) {
  if (!box) return std::nullopt;
  IndexBox region;
  for (size_t m = 0; m < 3; ++m) {
    region.min[m] = static_cast<int32_t>(box->lo[m]);
    region.max[m] = static_cast<int32_t>(box->hi[m] + 1);
  }
  return region;
}

class LinksOnLattice : public testing::TestWithParam<ExactLattice> {};

INSTANTIATE_TEST_SUITE_P(Exact, LinksOnLattice, testing::ValuesIn(RestoredLattices()),
                         [](const auto& lattice) { return lattice.param.name; });

// The mesh lies across the borders of tiles.
TEST_P(LinksOnLattice, AreThoseOfTheOracleOnAdversarialMeshes) {
  const Lattice& lattice = GetParam().lattice;
  size_t voxels = 0, on_points = 0, several = 0, number = GetParam().name.size();
  for (int k : Dose<std::vector<int>>({0, 1, 2}, {0})) {
    const std::vector<Int3> directions = Directions(lattice.frames(k));
    if (k > 0 && directions == Directions(lattice.frames(k - 1))) continue;
    const std::vector<Vec3i> neighbors = NeighborsOf(lattice.frames(k));
    for (const oracle::NamedMesh& mesh : oracle::AdversarialMeshes(static_cast<uint64_t>(30 + k), directions)) {
      if (number++ % 4 != 0) continue;  // the oracle takes its time
      SCOPED_TRACE(mesh.name + " k " + std::to_string(k));
      const Vec3i shift = mesh.box ? Vec3i{} : Vec3i{62, -3, 61};
      const LinkOracle oracle(mesh.triangles, directions, mesh.box);
      const VoxelizeOptions options{.separability = k, .region = RegionOf(mesh.box), .set = Links{}, .fields = kAll};
      const auto found = LinksOf(Voxelize(ToWorld(mesh.triangles, lattice, shift), Unscaled(lattice), options),
                                 neighbors.size(), shift);
      ASSERT_EQ(found.size(), oracle.links().size());
      for (const auto& [z, links] : found) {
        SCOPED_TRACE(testing::Message() << z[0] << ' ' << z[1] << ' ' << z[2]);
        ExpectVoxel(links, oracle.At(z), neighbors);
        if (testing::Test::HasFailure()) return;
        for (const auto& [q, link] : oracle.At(z)) {
          on_points += link.share == 0 ? 1 : 0;
          several += link.crossings > 1 ? 1 : 0;
        }
      }
      voxels += found.size();
    }
  }
  EXPECT_GT(voxels, 1000U);
  EXPECT_GT(on_points, 100U);
  EXPECT_GT(several, 1000U);
}

TEST_P(LinksOnLattice, AreCrossedAnOddNumberOfTimesWhereTheParityOfClosedMeshesDiffers) {
  const Lattice& lattice = GetParam().lattice;
  size_t number = 0, odd = 0;
  for (const oracle::NamedMesh& mesh : oracle::AdversarialMeshes(40, Directions(lattice.frames(0)))) {
    if (!mesh.closed || mesh.box) continue;
    SCOPED_TRACE(mesh.name);
    const auto k = static_cast<int>(number++ % 3);
    // Forced, because some of these meshes are closed for every line without sharing edges.
    odd += ExpectParity(ToWorld(mesh.triangles, lattice, {62, -3, 61}), Unscaled(lattice), k, true);
  }
  EXPECT_GT(odd, 500U);
}

TEST(Links, AreCrossedAnOddNumberOfTimesWhereTheParityOfABumpySphereDiffers) {
  for (const NamedLattice name : {NamedLattice::kCartesian, NamedLattice::kBcc, NamedLattice::kFcc}) {
    for (int k : {0, 2}) EXPECT_GT(ExpectParity(Sphere(30, 20), Unscaled(Lattice::Named(name)), k, true), 5000U);
    // Its triangles are tiny.
    EXPECT_GT(ExpectParity(Sphere(200, 15), Unscaled(Lattice::Named(name)), 1, true), 5000U);
  }
}

std::set<Int3> Difference(const std::set<Int3>& a, const std::set<Int3>& b) {
  std::set<Int3> out;
  std::ranges::set_difference(a, b, std::inserter(out, out.end()));
  return out;
}

TEST(Links, ContainTheSurfaceAndHaveTwoSides) {
  for (const int rings : {25, 250}) {
    const TriangleMesh mesh = Sphere(rings, 35);
    const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
    const auto ends = [&](LinkSide side) { return VoxelsOf(Voxelize(mesh, grid, {.set = Links{side}})); };
    const std::set<Int3> both = ends(LinkSide::kBoth), in = ends(LinkSide::kInside), out = ends(LinkSide::kOutside);
    const std::set<Int3> surface = VoxelsOf(Voxelize(mesh, grid, {.minimal = false}));
    EXPECT_TRUE(std::ranges::includes(both, surface));
    const Solid solid{.rule = InteriorRule::kParity, .surface = SolidSurface::kNone};
    const std::set<Int3> outside = Difference(both, VoxelsOf(Voxelize(mesh, grid, {.set = solid})));
    EXPECT_EQ(out, outside);
    EXPECT_EQ(in, Difference(both, outside));
    EXPECT_GT(in.size(), 5000U);
    EXPECT_GT(out.size(), in.size());
  }
}

// As in the set of links, and nothing elsewhere.
TEST(Links, AreFieldsOfEverySet) {
  const TriangleMesh mesh = Sphere(40, 20);
  for (const NamedLattice name : {NamedLattice::kCartesian, NamedLattice::kBcc}) {
    const Grid grid = Unscaled(Lattice::Named(name));
    const size_t neighbors = NeighborsOf(grid.lattice.frames(1)).size();
    const auto links = LinksOf(Voxelize(mesh, grid, {.separability = 1, .set = Links{}, .fields = kAll}), neighbors);
    for (const SetOption& set : {SetOption{SeparatingSurface{}}, SetOption{SupercoverSurface{}}, SetOption{Solid{}},
                                 SetOption{Band{0.1, true}}, SetOption{Solid{.surface = SolidSurface::kNone}},
                                 SetOption{Band{2.5, true}}, SetOption{Links{LinkSide::kInside}}, SetOption{Enclosed{}},
                                 SetOption{Solid{.surface = SolidSurface::kSupercover}}, SetOption{Connected{}},
                                 SetOption{Connected{{0, 0, 0}, 1.7, false}}}) {
      SCOPED_TRACE(set.index());
      const auto found = LinksOf(Voxelize(mesh, grid, {.separability = 1, .set = set, .fields = kAll}), neighbors);
      size_t crossed = 0;
      for (const auto& [z, of_voxel] : found) {
        const auto expected = links.find(z);
        if (expected == links.end()) {
          EXPECT_EQ(std::ranges::count(of_voxel.crossings, 0U), static_cast<ptrdiff_t>(neighbors));
          EXPECT_TRUE(std::ranges::all_of(of_voxel.shares, [](float share) { return std::isnan(share); }));
          continue;
        }
        ++crossed;
        EXPECT_EQ(of_voxel.crossings, expected->second.crossings);
        EXPECT_EQ(of_voxel.triangles, expected->second.triangles);
      }
      EXPECT_GT(crossed, 100U);
    }
  }
}

// Shares, regions and single fields are those of the whole.
TEST(Links, OfPartsAreThoseOfTheWhole) {
  const TriangleMesh mesh = Sphere(60, 45);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kFcc));
  const size_t neighbors = NeighborsOf(grid.lattice.frames(0)).size();
  const VoxelizeOptions whole{.set = Links{}, .fields = kAll};
  const Result all = Voxelize(mesh, grid, whole);
  const JobTotals sum = TotalsOfShards(mesh, grid, whole, 3);
  EXPECT_EQ(sum.voxels, all.totals.voxels);
  EXPECT_EQ(sum.digest, all.totals.digest);
  EXPECT_EQ(sum.fields, all.totals.fields);
  VoxelizeOptions some = whole;
  some.region = IndexBox{{-7, -70, 5}, {40, 3, 69}};
  some.fields = {Field::kLinkTriangles};
  const Result part = Voxelize(mesh, grid, some);
  const auto found = LinksOf(all, neighbors);
  size_t in_region = 0;
  for (const auto& [z, of_voxel] : found) {
    in_region += some.region->Contains({int32_t(z[0]), int32_t(z[1]), int32_t(z[2])}) ? 1 : 0;
  }
  const auto of_part = FieldsByVoxel(part.tiles, some.fields, neighbors);
  EXPECT_EQ(of_part.size(), in_region);
  EXPECT_GT(in_region, 1000U);
  for (const auto& [ijk, fields] : of_part) {
    EXPECT_EQ(NumbersIn<uint32_t>(fields[0]), found.at(ToOracle(ijk)).triangles);
  }
}

TEST(Links, DoNotDependOnKernelsOrTheOrderOfTriangles) {
  TriangleMesh mesh = Sphere(60, 10);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  const VoxelizeOptions options{.set = Links{}, .fields = {Field::kLinks, Field::kLinkCrossings}};
  const JobTotals expected = Voxelize(mesh, grid, options).totals;
  std::ranges::reverse(mesh.triangles);
  WithEachSimd([&] {
    for (const int threads : {1, 2}) {
      const JobTotals totals = Voxelize(mesh, grid, options, threads).totals;
      EXPECT_EQ(totals.digest, expected.digest);
      EXPECT_EQ(totals.fields, expected.fields);
    }
  });
}

// A plane through lattice points: the shift moves it up. Points on it have a link below at no distance.
TEST(Links, OfAPointOnTheMeshBelongToOneSide) {
  TriangleMesh mesh;
  mesh.vertices = {{-9, -9, 0}, {9, -9, 0}, {0, 18, 0}};
  mesh.triangles = {{0, 1, 2}};
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  const std::vector<Vec3i> neighbors = NeighborsOf(grid.lattice.frames(2));
  ASSERT_EQ(neighbors, (std::vector<Vec3i>{{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {0, 0, 1}, {0, 1, 0}, {1, 0, 0}}));
  const auto found =
      LinksOf(Voxelize(mesh, grid, {.separability = 2, .set = Links{}, .fields = kAll}), neighbors.size());
  const FoundLinks &on = found.at({0, 0, 0}), &above = found.at({0, 0, 1});
  EXPECT_EQ(on.crossings, (std::vector<uint32_t>{0, 0, 0, 1, 0, 0}));
  EXPECT_EQ(on.shares[3], kShareOnPoint);
  EXPECT_EQ(above.shares[2], 1);
  EXPECT_FALSE(found.contains({0, 0, -1}));
}

TEST(LinkShare, IsRoundedToTheNearestFloat) {
  std::mt19937_64 random(3);
  for (int n = 0; n < 20000; ++n) {
    uint64_t denominator = (random() >> (2 + random() % 60)) + 1, numerator = random() % denominator + 1;
    if (n % 2 == 0) {  // next to the middle between two floats
      const auto whole = (uint64_t{1} << 24) + 2 * (random() % (uint64_t{1} << 23)) + 1;
      const uint64_t scale = (random() % (uint64_t{1} << 35)) + 1;
      denominator = scale << 25;
      numerator = whole * scale + random() % 3 - 1;
    }
    const mpq_class exact(mpz_class(std::to_string(numerator)), mpz_class(std::to_string(denominator)));
    mpq_class share = exact;
    share.canonicalize();
    EXPECT_TRUE(StandsFor(LinkShare({numerator, denominator}).ToFloat(), share)) << share;
  }
  EXPECT_EQ(LinkShare({0, 5}).ToFloat(), kShareOnPoint);
  EXPECT_EQ(LinkShare({5, 5}).ToFloat(), 1);
  // Between 0 and every other share.
  EXPECT_LT(kShareOnPoint, LinkShare({1, (uint64_t{1} << 62) - 1}).ToFloat());
}

TEST(Links, OfOneSideNeedAClosedMesh) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {9, 0, 0}, {0, 9, 0}};
  mesh.triangles = {{0, 1, 2}};
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  const auto job = VoxelizeJob::Create(mesh, grid, {.set = Links{LinkSide::kOutside}});
  EXPECT_EQ(job.status().message(), "mesh: it is not closed, which a side of links asks for");
}

}  // namespace
}  // namespace latvox
