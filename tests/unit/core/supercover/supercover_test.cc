// The supercover of a single triangle equals exact clipping. The supercover of a mesh is the union over its triangles.
#include "core/supercover/supercover.h"

#include <gtest/gtest.h>

#include <random>

#include "core/snap/snap.h"
#include "core/tiny/fineness.h"
#include "core/verify/verify.h"
#include "core/voxelizer/estimate.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/simd.h"
#include "tests/unit/core/sphere.h"
#include "tests/unit/core/supercover/row_by_row.h"

namespace latvox {
namespace {

using oracle::Int3;

struct CoveredLattice {
  std::string name;
  Lattice lattice;
  oracle::Gram<3> gram;
};

// Integer bases; the hexagonal lattice, which has no integer basis; and two that are rounded to 30 bits.
std::vector<CoveredLattice> Lattices() {
  std::vector<CoveredLattice> lattices;
  for (const ExactLattice& l : ExactLattices()) {
    lattices.push_back({l.name, l.lattice, oracle::GramOf<3>(l.lattice.basis())});
  }
  const mpq_class half(1, 2);
  lattices.push_back(
      {"hexagonal", Lattice::Named(NamedLattice::kHexagonal), {{{1, half, 0}, {half, 1, 0}, {0, 0, 1}}}});
  for (const auto& [name, basis] : std::vector<std::pair<std::string, Mat3d>>{
           {"skew", {{{1, 0.1, 0.03}, {0.37, 1.21, -0.2}, {0.21, -0.43, 0.94}}}},
           {"long", {{{-0.2, 0.47, -0.01}, {-0.11, -0.47, 0}, {-0.32, 0.11, 6.05}}}}}) {
    lattices.push_back({name, Lattice::FromBasis(basis).value(), oracle::GramOf<3>(basis)});
  }
  return lattices;
}

constexpr int32_t kFar = 1 << 20;
constexpr IndexBox kEverywhere{{-kFar, -kFar, -kFar}, {kFar, kFar, kFar}};

// Runs must neither repeat a row nor come out of order.
std::set<Int3> Covered(const Supercover& supercover, const Triangle& triangle, const IndexBox& box = kEverywhere) {
  std::set<Int3> voxels;
  std::optional<std::array<int32_t, 2>> row;
  supercover.ForEachRun(triangle, box, [&](const Vec3i& first, int32_t count) {
    const std::array<int32_t, 2> next{first[0], first[1]};
    EXPECT_TRUE(!row || *row < next);
    EXPECT_GT(count, 0);
    row = next;
    for (int32_t n = 0; n < count; ++n) voxels.insert({first[0], first[1], first[2] + n});
  });
  return voxels;
}

class SupercoverOnLattice : public testing::TestWithParam<CoveredLattice> {
 protected:
  static const oracle::CellClipper& Clipper() {
    static std::map<std::string, oracle::CellClipper> clippers;
    return clippers.try_emplace(GetParam().name, GetParam().gram).first->second;
  }
};

INSTANTIATE_TEST_SUITE_P(Exact, SupercoverOnLattice, testing::ValuesIn(Lattices()),
                         [](const auto& lattice) { return lattice.param.name; });

// Corners are multiples of `grain`: of 1, in general position; of 128 and 256, on the corners, edges and facets of
// cells, along axes and without area.
TEST_P(SupercoverOnLattice, EqualsExactClippingForEveryKindOfTriangle) {
  const auto cell = IntegerCell::Of(GetParam().lattice);
  ASSERT_TRUE(cell.ok()) << cell.status();
  const Supercover supercover(*cell);
  std::mt19937 random(7);
  size_t flat = 0;
  for (const auto& [grain, extent, count] :
       std::vector<std::array<int64_t, 3>>{{1, 200, 12}, {1, 700, 8}, {64, 8, 20}, {128, 5, 30}, {256, 2, 25}}) {
    for (int64_t n = 0; n < count; ++n) {
      oracle::Triangle triangle;
      for (Int3& v : triangle) {
        for (int64_t& x : v) x = grain * (static_cast<int64_t>(random() % static_cast<uint64_t>(2 * extent)) - extent);
      }
      if (n % 5 == 3) triangle[2] = triangle[1];
      if (n % 5 == 4) triangle[2] = triangle[1] = triangle[0];
      flat += triangle[1] == triangle[2] ? 1 : 0;
      const auto expected = Clipper().Supercover({triangle});
      ASSERT_FALSE(expected.empty());
      ASSERT_EQ(Covered(supercover, FromOracle(triangle)), expected) << "grain " << grain << " triangle " << n;
    }
  }
  EXPECT_GT(flat, 30U);
}

// Integers of all widths, up to the largest possible triangles, tested in a few places.
TEST_P(SupercoverOnLattice, EqualsExactClippingForHugeTriangles) {
  const auto cell = IntegerCell::Of(GetParam().lattice);
  ASSERT_TRUE(cell.ok()) << cell.status();
  const Supercover supercover(*cell);
  std::mt19937 random(8);
  for (int64_t extent = 1 << 12; extent <= 1 << 25; extent *= 8) {
    for (int n = 0; n < 3; ++n) {
      oracle::Triangle triangle;
      for (Int3& v : triangle) {
        for (int64_t& x : v) x = static_cast<int64_t>(random() % static_cast<uint64_t>(extent));
      }
      // Around a corner, the middle of an edge, and a point inside.
      for (const std::array<int64_t, 3>& weights : {std::array<int64_t, 3>{4, 0, 0}, {2, 2, 0}, {1, 2, 1}}) {
        IndexBox box;
        oracle::Box same;
        for (size_t m = 0; m < 3; ++m) {
          int64_t at = 0;
          for (size_t v = 0; v < 3; ++v) at += weights[v] * triangle[v][m];
          box.min[m] = static_cast<int32_t>(at / 1024 - 2);
          box.max[m] = box.min[m] + 5;
          same.lo[m] = box.min[m];
          same.hi[m] = box.max[m] - 1;
        }
        const auto expected = Clipper().Supercover({triangle}, same);
        ASSERT_FALSE(expected.empty());
        ASSERT_EQ(Covered(supercover, FromOracle(triangle), box), expected) << "extent " << extent;
      }
    }
  }
}

TEST_P(SupercoverOnLattice, NeighborsCellsMeetAndFacetsAreThoseOfTheLattice) {
  const auto cell = IntegerCell::Of(GetParam().lattice);
  ASSERT_TRUE(cell.ok()) << cell.status();
  std::vector<Vec3i> facets;
  for (const auto& neighbor : GetParam().lattice.neighbors()) {
    if (neighbor.face_dimension == 2 && FirstNonzeroIsPositive(neighbor.w)) facets.push_back(neighbor.w);
    for (const CellZone& zone : cell->zones()) EXPECT_LE(std::abs(Dot(zone.e, neighbor.w)), 1);
  }
  EXPECT_EQ(cell->facets(), facets);
}

Result Cover(const TriangleMesh& mesh, const Lattice& lattice, VoxelizeOptions options = {}, int threads = 2) {
  options.set = SupercoverSurface{};
  return Voxelize(mesh, Unscaled(lattice), options, threads);
}

// Before and after thinning, for every k.
TEST_P(SupercoverOnLattice, HoldsEverySeparatingSet) {
  const TriangleMesh sphere = Sphere(12, 9.3F);
  const auto whole = VoxelsOf(Cover(sphere, GetParam().lattice));
  for (int k : {0, 1, 2}) {
    for (bool minimal : {false, true}) {
      const auto separating =
          VoxelsOf(Voxelize(sphere, Unscaled(GetParam().lattice), {.separability = k, .minimal = minimal}));
      ASSERT_FALSE(separating.empty());
      EXPECT_TRUE(std::includes(whole.begin(), whole.end(), separating.begin(), separating.end())) << k << minimal;
      EXPECT_LE(separating.size(), whole.size() - (minimal ? 1U : 0U));
    }
  }
}

TEST_P(SupercoverOnLattice, HasNoTunnelForAnyKAndIsTheSameForEach) {
  const TriangleMesh sphere = Sphere(12, 9.3F);
  for (int k : {0, 1, 2}) {
    const VoxelizeOptions options{.separability = k, .set = SupercoverSurface{}};
    const Result result = Cover(sphere, GetParam().lattice, options);
    EXPECT_EQ(result.totals.digest, Cover(sphere, GetParam().lattice).totals.digest);
    VoxelSet voxels;
    for (const TileBricks& tile : result.tiles) {
      for (const Brick& brick : tile.bricks) voxels.Add(brick);
    }
    const auto job = VoxelizeJob::Create(sphere, Unscaled(GetParam().lattice), options);
    ASSERT_TRUE(job.ok()) << job.status();
    const auto verdict = (*job)->Verify(voxels);
    ASSERT_TRUE(verdict.ok());
    EXPECT_EQ(verdict->tunnels, 0U);
    EXPECT_GT(verdict->redundant, 0U);
  }
}

TEST_P(SupercoverOnLattice, PartsAndThreadsEqualTheWhole) {
  const TriangleMesh sphere = Sphere(16, 40.7F);
  const Lattice& lattice = GetParam().lattice;
  const Result whole = Cover(sphere, lattice, {}, 1);
  ASSERT_GT(whole.tiles.size(), 3U);
  const Result parallel = Cover(sphere, lattice, {}, 3);
  EXPECT_EQ(parallel.totals.digest, whole.totals.digest);
  Digest sum;
  for (uint32_t n = 0; n < 3; ++n) sum.Add(Cover(sphere, lattice, {.shard = Shard{n, 3}}).totals.digest);
  EXPECT_EQ(sum, whole.totals.digest);

  const IndexBox region{{-9, -20, 3}, {33, 8, 41}};
  std::set<Int3> within;
  for (const Int3& z : VoxelsOf(whole)) {
    const Vec3i ijk{static_cast<int32_t>(z[0]), static_cast<int32_t>(z[1]), static_cast<int32_t>(z[2])};
    if (region.Contains(ijk)) within.insert(z);
  }
  ASSERT_FALSE(within.empty());
  EXPECT_EQ(VoxelsOf(Cover(sphere, lattice, {.region = region})), within);

  const Vec3i middle = whole.tiles[whole.tiles.size() / 2].tile_ijk;
  EXPECT_EQ(Cover(sphere, lattice, {.resume_after = middle}).tiles.size(),
            whole.tiles.size() - whole.tiles.size() / 2 - 1);
}

// Many tiny triangles take another path on lattices whose cells are boxes (core/tiny/tiny_cover.h). They cross borders
// of tiles. Their corners are in general position, or multiples of half a voxel, on borders of cells and often without
// area. A few large triangles lie among them.
TEST(Supercover, OfTinyTrianglesIsThatOfEachRowByRowOnEachKernel) {
  const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  const Grid grid = Unscaled(lattice);
  std::mt19937 random(9);
  for (const int64_t grain : {1, 128}) {
    oracle::Mesh mesh = RandomTriangles(grain, kLatticeUnit * 3 / 2, 17000, random);
    for (oracle::Triangle& triangle : RandomTriangles(grain, 9000, 20, random)) mesh.push_back(triangle);
    const TriangleMesh world = ToWorld(mesh, lattice);
    ASSERT_TRUE(IsFineForCover(*Snap(world, lattice, grid.origin, {1, 1, 1})));
    const std::set<Int3> expected = RowByRow(mesh, lattice);
    std::set<Int3> within;
    const IndexBox region{{9, 20, 3}, {70, 65, 41}};
    for (const Int3& z : expected) {
      const Vec3i ijk{static_cast<int32_t>(z[0]), static_cast<int32_t>(z[1]), static_cast<int32_t>(z[2])};
      if (region.Contains(ijk)) within.insert(z);
    }
    WithEachSimd([&] {
      const Result whole = Cover(world, lattice, {}, 1);
      ASSERT_EQ(VoxelsOf(whole), expected) << "grain " << grain;
      EXPECT_EQ(Cover(world, lattice, {}, 3).totals.digest, whole.totals.digest);
      Digest sum;
      for (uint32_t n = 0; n < 3; ++n) sum.Add(Cover(world, lattice, {.shard = Shard{n, 3}}).totals.digest);
      EXPECT_EQ(sum, whole.totals.digest);
      EXPECT_EQ(VoxelsOf(Cover(world, lattice, {.region = region})), within);
    });
  }
}

// Sets and fields whose tiles need the triangles themselves.
TEST(Supercover, OfTinyTrianglesIsTheSameWithFieldsAndInSolidsOnEachKernel) {
  const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  const TriangleMesh sphere = Sphere(120, 28);
  ASSERT_TRUE(IsFineForCover(*Snap(sphere, lattice, {}, {1, 1, 1})));
  for (const VoxelizeOptions& options : {VoxelizeOptions{.set = SupercoverSurface{}},
                                         {.set = Solid{.surface = SolidSurface::kSupercover}},
                                         {.set = SupercoverSurface{}, .fields = {Field::kTriangle, Field::kLinks}}}) {
    std::optional<Digest> expected;  // of plain C++, which comes first
    WithEachSimd([&] {
      const Digest digest = Voxelize(sphere, Unscaled(lattice), options).totals.digest;
      EXPECT_EQ(digest, expected.value_or(digest));
      expected = digest;
    });
  }
}

// World coordinates of the others would be rounded.
class SupercoverOnExactLattice : public SupercoverOnLattice {};

std::vector<CoveredLattice> LatticesOfIntegers() {
  std::vector<CoveredLattice> lattices = Lattices();
  lattices.erase(lattices.begin() + static_cast<std::ptrdiff_t>(ExactLattices().size()), lattices.end());
  return lattices;
}

INSTANTIATE_TEST_SUITE_P(Exact, SupercoverOnExactLattice, testing::ValuesIn(LatticesOfIntegers()),
                         [](const auto& lattice) { return lattice.param.name; });

TEST_P(SupercoverOnExactLattice, PipelineEqualsExactClippingOnAdversarialMeshes) {
  const CoveredLattice& l = GetParam();
  size_t meshes = 0;
  for (const auto& mesh : oracle::AdversarialMeshes(5, Directions(l.lattice.frames(0)))) {
    if (mesh.box || mesh.triangles.size() > 8) continue;
    ++meshes;
    const auto expected = Clipper().Supercover(mesh.triangles);
    for (const Vec3i& shift : {Vec3i{0, 0, 0}, Vec3i{59, 61, 63}}) {
      const Result result = Cover(ToWorld(mesh.triangles, l.lattice, shift), l.lattice);
      ASSERT_EQ(VoxelsOf(result, shift), expected) << l.name << " " << mesh.name;
    }
  }
  EXPECT_GT(meshes, 5U);
}

TEST(Supercover, CountsCellsThatTouchAtFacetsEdgesAndCorners) {
  const auto count = [](NamedLattice name, const Triangle& triangle) {
    return Covered(Supercover(IntegerCell::Of(Lattice::Named(name)).value()), triangle).size();
  };
  const auto point = [](int32_t i, int32_t j, int32_t k) { return Triangle{{{i, j, k}, {i, j, k}, {i, j, k}}}; };
  EXPECT_EQ(count(NamedLattice::kCartesian, point(0, 0, 0)), 1U);
  EXPECT_EQ(count(NamedLattice::kCartesian, point(128, 0, 0)), 2U);
  EXPECT_EQ(count(NamedLattice::kCartesian, point(128, 128, 0)), 4U);
  EXPECT_EQ(count(NamedLattice::kCartesian, point(128, 128, 128)), 8U);
  // The triangle lies half a voxel above a layer, with its corners at corners of cells. It touches 4 x 4 cells in both
  // layers, except the three beyond the middle of the hypotenuse.
  EXPECT_EQ(count(NamedLattice::kCartesian, {{{128, 128, 128}, {640, 128, 128}, {128, 640, 128}}}), 2U * 13U);
  // BCC: center of a square and of a hexagonal facet, a corner, where four truncated octahedra meet.
  EXPECT_EQ(count(NamedLattice::kBcc, point(128, 0, 0)), 2U);
  EXPECT_EQ(count(NamedLattice::kBcc, point(0, 0, 128)), 2U);
  EXPECT_EQ(count(NamedLattice::kBcc, point(0, 64, 0)), 1U);
  EXPECT_EQ(count(NamedLattice::kBcc, point(128, 64, 0)), 4U);
  // FCC: octahedral holes are corners of six rhombic dodecahedra, tetrahedral ones of four.
  EXPECT_EQ(count(NamedLattice::kFcc, point(128, 128, -128)), 6U);
  EXPECT_EQ(count(NamedLattice::kFcc, point(64, 64, 64)), 4U);
}

TEST(Supercover, IsEstimatedToHaveNoFewerVoxelsThanItHas) {
  for (float radius : {0.4F, 3.0F, 30.0F}) {
    for (NamedLattice name : {NamedLattice::kCartesian, NamedLattice::kBcc, NamedLattice::kFcc}) {
      const Lattice lattice = Lattice::Named(name);
      const TriangleMesh sphere = Sphere(16, radius);
      const VoxelizeOptions options{.set = SupercoverSurface{}};
      const double voxels = EstimateVoxels(sphere, ExtentOf(sphere), Unscaled(lattice), *MakeRequest(options));
      EXPECT_GE(voxels, static_cast<double>(Cover(sphere, lattice).totals.voxels));
      EXPECT_GT(EstimateVisits(sphere, ExtentOf(sphere), Unscaled(lattice), *MakeRequest(options)), voxels);
    }
  }
}

TEST(Supercover, RefusesTheThesisAlgorithmsAndLatticesItCannotTell) {
  const TriangleMesh sphere = Sphere(4, 3);
  const Grid cartesian = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  const auto other =
      VoxelizeJob::Create(sphere, cartesian, {.algorithm = Algorithm::kIncremental, .set = SupercoverSurface{}});
  EXPECT_EQ(other.status().message(), "supercover: not together with algorithm incremental");

  const auto flat = Lattice::FromBasis({{{1, 0.3, 0}, {0.2, 1.1, 0}, {0.3, 0.4, 7000}}});
  ASSERT_TRUE(flat.ok());
  const auto refused = VoxelizeJob::Create(sphere, Unscaled(*flat), {.set = SupercoverSurface{}});
  EXPECT_EQ(refused.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_TRUE(VoxelizeJob::Create(sphere, Unscaled(*flat), {}).ok());
}

}  // namespace
}  // namespace latvox
