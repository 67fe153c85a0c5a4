// Sets that a walk decides equal a flood fill, point by point.
#include <gtest/gtest.h>

#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/voxelizer/voxelizer.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/fields/shards.h"
#include "tests/unit/core/sphere.h"
#include "tests/unit/core/walk/answers.h"
#include "tests/unit/core/walk/flood.h"
#include "tests/unit/dose.h"

namespace latvox {
namespace {

Points Without(const Points& a, const Points& b) {
  Points out;
  std::set_difference(a.begin(), a.end(), b.begin(), b.end(), std::inserter(out, out.end()));
  return out;
}

oracle::Box BoxOf(const oracle::Mesh& mesh, int64_t margin) {
  oracle::Box box{{INT64_MAX, INT64_MAX, INT64_MAX}, {INT64_MIN, INT64_MIN, INT64_MIN}};
  for (const oracle::Triangle& triangle : mesh) {
    for (const Int3& v : triangle) {
      for (size_t m = 0; m < 3; ++m) {
        box.lo[m] = std::min(box.lo[m], (v[m] >> 8) - margin);
        box.hi[m] = std::max(box.hi[m], (v[m] >> 8) + 1 + margin);
      }
    }
  }
  return box;
}

Points SurfaceOf(const TriangleMesh& mesh, const Lattice& lattice, int64_t k, bool minimal, const Vec3i& shift) {
  return VoxelsOf(Voxelize(mesh, Unscaled(lattice), {.separability = k, .minimal = minimal}), shift);
}

struct Case {
  ExactLattice lattice;
  int64_t k;
  size_t number = 0;
};

std::vector<Case> Cases() {
  std::vector<Case> cases;
  for (const ExactLattice& lattice : RestoredLattices()) {
    for (const int64_t k : {0, 1, 2}) cases.push_back({lattice, k});
  }
  // Their basis vectors along j or along k are no steps.
  const Mat3d skewed_j{{{1, 0, 0}, {2, 1, 0}, {0, 0, 1}}}, skewed_k{{{1, 0, 0}, {0, 1, 0}, {0, 2, 1}}};
  cases.push_back({{"skewed_j", Lattice::FromBasis(skewed_j).value()}, 2});
  cases.push_back({{"skewed_k", Lattice::FromBasis(skewed_k).value()}, 2});
  for (size_t n = 0; n < cases.size(); ++n) cases[n].number = n;
  return cases;
}

class WalkOnLattice : public testing::TestWithParam<Case> {};

INSTANTIATE_TEST_SUITE_P(Exact, WalkOnLattice, testing::ValuesIn(Cases()),
                         [](const auto& test) { return test.param.lattice.name + "_" + std::to_string(test.param.k); });

// In one tile, over the corner of eight tiles, and at negative coordinates.
constexpr Vec3i kShifts[] = {{8, 8, 8}, {60, 59, 61}, {-68, 1022, -1}};

// Each case takes some of the meshes, and together they take all several times.
TEST_P(WalkOnLattice, EqualsAFloodOfAdversarialMeshes) {
  constexpr size_t kCasesForAll = 9;
  const Lattice& lattice = GetParam().lattice.lattice;
  const int64_t k = GetParam().k;
  const std::vector<Int3> directions = Directions(lattice.frames(static_cast<int>(k)));
  size_t index = GetParam().number, count = 0, more_than_walls = 0;
  for (const oracle::NamedMesh& named : oracle::AdversarialMeshes(5, directions)) {
    if (named.box || ++index % kCasesForAll != 0) continue;
    const Flood flood(BoxOf(named.triangles, 9), directions);
    const Vec3i shift = kShifts[count++ % 3];
    const bool minimal = count % 2 == 0;
    const TriangleMesh mesh = ToWorld(named.triangles, lattice, shift);
    const Points walls = SurfaceOf(mesh, lattice, k, minimal, shift);
    const Points enclosed = flood.Unmarked(flood.FromOutside(flood.MarksOf(walls)));
    for (const SolidSurface surface : {SolidSurface::kSeparating, SolidSurface::kNone}) {
      const Points expected = surface == SolidSurface::kNone ? Without(enclosed, walls) : enclosed;
      const Result result = Voxelize(mesh, Unscaled(lattice),
                                     {.separability = k, .minimal = minimal, .set = Enclosed{.surface = surface}},
                                     count % 4 == 0 ? 2 : 1);
      ASSERT_EQ(VoxelsOf(result, shift), expected) << named.name << " " << count;
    }
    if (enclosed.size() > walls.size()) ++more_than_walls;
  }
  EXPECT_GT(count, 3U);
  EXPECT_GT(more_than_walls, 0U);
}

Points Within(const IndexBox& box, Points points, const Vec3i& shift) {
  std::erase_if(points, [&](const Int3& z) {
    return !box.Contains(Vec3i{static_cast<int32_t>(z[0]), static_cast<int32_t>(z[1]), static_cast<int32_t>(z[2])} +
                         shift);
  });
  return points;
}

void Append(oracle::Mesh& mesh, const oracle::Mesh& more) { mesh.insert(mesh.end(), more.begin(), more.end()); }

// A room of 12 steps a side with an inner wall and a shell in it; the wall leaves a channel one step wide.
oracle::Mesh Rooms() {
  oracle::Mesh mesh = Box({100, 110, 120}, {3100, 3110, 3120});
  Append(mesh, Box({1500, 100, 100}, {1620, 2700, 3150}));
  Append(mesh, Box({2000, 500, 500}, {2800, 1300, 1300}));
  return mesh;
}

// The room without one of its outer triangles.
oracle::Mesh OpenRooms() {
  oracle::Mesh mesh = Rooms();
  mesh.erase(mesh.begin());
  return mesh;
}

TEST_P(WalkOnLattice, FindsRegionsAndCavities) {
  const Lattice& lattice = GetParam().lattice.lattice;
  const int64_t k = GetParam().k;
  const std::vector<Int3> directions = Directions(lattice.frames(static_cast<int>(k)));
  const Vec3i shift = kShifts[1], seed{4, 4, 4}, far{-3, 2, 2};
  for (const bool is_open : {false, true}) {
    const oracle::Mesh rooms = is_open ? OpenRooms() : Rooms();
    const TriangleMesh mesh = ToWorld(rooms, lattice, shift);
    const Flood flood(BoxOf(rooms, 9), directions);
    const Flood::Marks walls = flood.MarksOf(SurfaceOf(mesh, lattice, k, true, shift));
    const Flood::Marks outside = flood.FromOutside(walls);
    const bool leaks = outside[flood.NumberOf(ToOracle(seed))] != 0;
    const Answer enclosed = AnswerTo(mesh, lattice, {.separability = k, .set = Enclosed{}}, shift);
    ASSERT_TRUE(enclosed.status.ok()) << enclosed.status;
    EXPECT_EQ(enclosed.points, flood.Unmarked(outside));
    const std::vector<uint64_t> cavities = flood.Cavities(walls, outside);
    EXPECT_EQ(enclosed.facts->cavities, cavities.size());
    EXPECT_EQ(enclosed.facts->largest, cavities);
    const Connected from_seed{.seed = WorldOf(lattice, seed + shift), .close = 0, .allow_outside = false};
    const Answer region = AnswerTo(mesh, lattice, {.separability = k, .set = from_seed}, shift);
    EXPECT_EQ(region.status.ok(), !leaks) << region.status;
    if (!leaks) {
      EXPECT_EQ(region.points, flood.Marked(flood.FromSeed(walls, ToOracle(seed))));
      EXPECT_FALSE(region.points.empty());
    }
    // From outside, the region is the rest of the box.
    const Connected from_outside{.seed = WorldOf(lattice, far + shift), .close = 0, .allow_outside = true};
    const Answer rest = AnswerTo(mesh, lattice, {.separability = k, .set = from_outside}, shift);
    ASSERT_TRUE(rest.status.ok()) << rest.status;
    EXPECT_EQ(rest.points, Within(rest.box, flood.Marked(outside), shift));
  }
}

TEST_P(WalkOnLattice, ClosesHoles) {
  const Lattice& lattice = GetParam().lattice.lattice;
  const int64_t k = GetParam().k;
  const std::vector<Int3> directions = Directions(lattice.frames(static_cast<int>(k)));
  const Vec3i shift = kShifts[GetParam().number % 3];
  // An opening about three steps wide, from one side of the box to the other.
  oracle::Mesh box = Box({130, 110, 120}, {2600, 2610, 2620});
  box[0] = {Int3{130, 110, 120}, Int3{2600, 2610, 120}, Int3{130, 1900, 120}};
  const double shortest = lattice.voxel_size();
  const TriangleMesh mesh = ToWorld(box, lattice, shift);
  const Flood flood(BoxOf(box, 12), directions);
  const Points surface = SurfaceOf(mesh, lattice, k, true, shift);
  const Flood::Marks walls = flood.MarksOf(surface);
  size_t inner = 0;
  for (const double close : {1.237 * shortest, 3.103 * shortest, 4.119 * shortest}) {
    const Points near = VoxelsOf(Voxelize(mesh, Unscaled(lattice), {.set = Band{close / 2, false}}), shift);
    Flood::Marks thick = walls;
    for (const Int3& z : near) thick[flood.NumberOf(z)] = 1;
    const Flood::Marks reached = flood.FromOutside(thick);
    const Flood::Marks outside = flood.Grown(walls, reached, lattice.basis(), close / 2);
    const Answer enclosed = AnswerTo(mesh, lattice, {.separability = k, .set = Enclosed{.close = close}}, shift);
    ASSERT_TRUE(enclosed.status.ok()) << enclosed.status;
    EXPECT_EQ(enclosed.points, flood.Unmarked(outside)) << close;
    EXPECT_EQ(enclosed.facts->cavities, flood.Cavities(thick, reached).size());
    // A region in the box, unless it leaks, and the one around it.
    for (const Vec3i& seed : {Vec3i{5, 5, 5}, Vec3i{-11, -11, -11}}) {
      const size_t number = flood.NumberOf(ToOracle(seed));
      const bool is_outside = seed[0] < 0, leaks = reached[number] != 0;
      const Connected set{.seed = WorldOf(lattice, seed + shift), .close = close, .allow_outside = is_outside};
      const Answer region = AnswerTo(mesh, lattice, {.separability = k, .set = set}, shift);
      ASSERT_EQ(region.status.ok(), thick[number] == 0 && (is_outside || !leaks)) << close << region.status;
      if (!region.status.ok()) continue;
      const Flood::Marks from_seed = leaks ? reached : flood.FromSeed(thick, ToOracle(seed));
      const Flood::Marks grown = flood.Grown(walls, from_seed, lattice.basis(), close / 2, leaks);
      EXPECT_EQ(region.points, Within(region.box, flood.Marked(grown), shift)) << close;
      EXPECT_FALSE(region.points.empty());
      inner += is_outside ? 0 : 1;
    }
  }
  EXPECT_GT(inner, 0U);
}

// The walk keeps out of 70 million points around one triangle, and grows back to its surface. With
// sanitizers, core_growth_test alone grows by such a ball.
TEST(Walk, MayCloseHolesOf512Voxels) {
  if (kSlowed) GTEST_SKIP() << "takes a hundred million distances";
  const TriangleMesh mesh = ToWorld({{Int3{0, 0, 0}, Int3{256, 0, 0}, Int3{0, 256, 128}}}, Cartesian());
  const Points surface = VoxelsOf(Voxelize(mesh, Unscaled(Cartesian()), {}));
  const Points closed = VoxelsOf(Voxelize(mesh, Unscaled(Cartesian()), {.set = Enclosed{.close = 512}}));
  EXPECT_TRUE(std::ranges::includes(closed, surface));
  EXPECT_LE(closed.size(), surface.size() + 8);  // points that lie beside it, and are reached by a longer way
}

// So fine a mesh has tiny triangles, whose links are found at once, and others. Distances need all of them.
TEST(Walk, ClosesHolesOfFineMeshes) {
  TriangleMesh mesh = Sphere(92, 24);
  mesh.triangles.resize(mesh.triangles.size() - 1500);  // an opening around the pole
  const TriangleMesh floor = ToWorld(Box({-7000, -7000, -8000}, {7000, 7000, -7000}), Cartesian());
  const auto first = static_cast<uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), floor.vertices.begin(), floor.vertices.end());
  for (const auto& [a, b, c] : floor.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
  const Flood flood({{-40, -40, -40}, {40, 40, 40}}, Directions(Cartesian().frames(0)));
  const Points surface = VoxelsOf(Voxelize(mesh, Unscaled(Cartesian()), {}));
  const Flood::Marks walls = flood.MarksOf(surface);
  for (const double close : Dose<std::vector<double>>({3.3, 7.1}, {7.1})) {
    Flood::Marks thick = walls;
    for (const Int3& z : VoxelsOf(Voxelize(mesh, Unscaled(Cartesian()), {.set = Band{close / 2, false}}))) {
      thick[flood.NumberOf(z)] = 1;
    }
    const Flood::Marks outside = flood.Grown(walls, flood.FromOutside(thick), Cartesian().basis(), close / 2);
    const Points enclosed = VoxelsOf(Voxelize(mesh, Unscaled(Cartesian()), {.set = Enclosed{.close = close}}));
    EXPECT_EQ(enclosed, flood.Unmarked(outside)) << close;
    EXPECT_EQ(enclosed.size() > 2 * surface.size(), close > 5) << enclosed.size();
  }
}

// All triangles are tiny, so no tile lists any, and all walls come from links. The tiles that are delivered need no
// walls with the surface, and need them without it.
TEST(Walk, OfMeshesWhoseTrianglesAreAllTiny) {
  const TriangleMesh mesh = Sphere(92, 11);
  for (const NamedLattice named : {NamedLattice::kCartesian, NamedLattice::kFcc}) {
    const Lattice lattice = Lattice::Named(named);
    for (const int k : {0, 2}) {
      const Flood flood({{-40, -40, -40}, {40, 40, 40}}, Directions(lattice.frames(k)));
      const Points walls = VoxelsOf(Voxelize(mesh, Unscaled(lattice), {.separability = k}));
      const Points enclosed = flood.Unmarked(flood.FromOutside(flood.MarksOf(walls)));
      EXPECT_GT(enclosed.size(), 2 * walls.size());
      const Result result = Voxelize(mesh, Unscaled(lattice), {.separability = k, .set = Enclosed{}});
      EXPECT_EQ(VoxelsOf(result), enclosed);
      ASSERT_EQ(result.tiles.size(), 8U);
      EXPECT_GT(result.tiles.front().progress, 0);
      EXPECT_LT(result.tiles.front().progress, 0.5);
      EXPECT_GT(result.tiles.back().progress, 0.9);
      const Enclosed inner{.surface = SolidSurface::kNone};
      EXPECT_EQ(VoxelsOf(Voxelize(mesh, Unscaled(lattice), {.separability = k, .set = inner})),
                Without(enclosed, walls));
    }
  }
}

TEST(Walk, ContainsTheSolidOfAClosedMesh) {
  const TriangleMesh mesh = Sphere(40, Dose(75.0F, 40.0F));
  const Points solid = VoxelsOf(Voxelize(mesh, Unscaled(Cartesian()), {.set = Solid{}}));
  const Points enclosed = VoxelsOf(Voxelize(mesh, Unscaled(Cartesian()), {.set = Enclosed{}}));
  EXPECT_TRUE(std::includes(enclosed.begin(), enclosed.end(), solid.begin(), solid.end()));
  EXPECT_EQ(enclosed, solid);  // it has no inner shell
  oracle::Mesh shells = Box({100, 100, 100}, {3000, 3000, 3000});
  Append(shells, Box({900, 900, 900}, {2200, 2200, 2200}));
  const TriangleMesh nested = ToWorld(shells, Cartesian());
  const Points hollow = VoxelsOf(Voxelize(nested, Unscaled(Cartesian()), {.set = Solid{InteriorRule::kParity}}));
  const Points filled = VoxelsOf(Voxelize(nested, Unscaled(Cartesian()), {.set = Enclosed{}}));
  EXPECT_TRUE(std::includes(filled.begin(), filled.end(), hollow.begin(), hollow.end()));
  EXPECT_TRUE(filled.contains({6, 6, 6}) && !hollow.contains({6, 6, 6}));  // in the inner shell
}

// Shards, regions and resumed jobs deliver what the whole does, though each looks at the whole mesh.
TEST(Walk, PartsAreThoseOfTheWhole) {
  TriangleMesh mesh = Sphere(60, 75);
  mesh.triangles.erase(mesh.triangles.end() - 41);  // near the pole: a hole that no step fits through
  const Grid grid = Unscaled(Cartesian());
  for (const double close : Dose<std::vector<double>>({0.0, 3.3}, {3.3})) {
    for (const SetOption& set : Dose<std::vector<SetOption>>(
             {Enclosed{.close = close}, Connected{{1, 2, 3}, close, false}, Connected{{-74, -74, -74}, close, true}},
             {Enclosed{.close = close}, Connected{{1, 2, 3}, close, false}})) {
      SCOPED_TRACE(testing::Message() << close << ' ' << set.index());
      VoxelizeOptions options{.separability = 2, .set = set};
      const Result whole = Voxelize(mesh, grid, options);
      EXPECT_GT(whole.totals.voxels, 1'000'000U);
      ExpectPartsAddUp(mesh, grid, options, whole);
      options.region = IndexBox{{-20, 30, -71}, {3, 70, 40}};
      JobTotals expected;
      for (const TileBricks& tile : whole.tiles) {
        for (Brick brick : tile.bricks) {
          ClipBrick(*options.region, brick);
          if (CountVoxels(brick.mask) == 0) continue;
          expected.digest.Add(brick);
          expected.voxels += CountVoxels(brick.mask);
        }
      }
      EXPECT_GT(expected.voxels, 0U);
      const Result part = Voxelize(mesh, grid, options, 1);
      EXPECT_EQ(part.totals.voxels, expected.voxels);
      EXPECT_EQ(part.totals.digest, expected.digest);
    }
  }
}

}  // namespace
}  // namespace latvox
