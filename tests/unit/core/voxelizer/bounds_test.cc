// A job within a box of the world delivers the whole, filtered with rational arithmetic.
#include <gmpxx.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "core/voxelizer/estimate.h"
#include "core/voxelizer/world_box.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/fields.h"
#include "tests/unit/core/sphere.h"

namespace latvox {
namespace {

using oracle::Int3;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Case {
  std::string name;
  Grid grid;
};

// The named lattices, whose positions are not doubles, a lattice of short numbers, and skewed ones; origins near and
// far.
std::vector<Case> Cases() {
  std::vector<Case> cases;
  for (const auto& [name, text] :
       {std::pair(NamedLattice::kCartesian, "cartesian"), std::pair(NamedLattice::kBcc, "bcc"),
        std::pair(NamedLattice::kFcc, "fcc"), std::pair(NamedLattice::kHexagonal, "hexagonal")}) {
    cases.push_back({text, {*Lattice::Named(name).Scaled(0.7), {0.1, -12.3, 0.7}}});
  }
  for (const auto& [text, basis] : std::vector<std::pair<std::string, Mat3d>>{
           {"quarters", {{{0.75, 0, 0}, {0.25, 0.75, 0}, {0.25, -0.25, 0.75}}}},
           {"skew", {{{0.7, 0.1, 0.03}, {0.37, 0.81, -0.2}, {0.21, -0.43, 0.94}}}},
           {"skewer", {{{0.7, 0, 0}, {1.3, 0.7, 0}, {0, 1.2, 0.7}}}}}) {
    cases.push_back({text, {*Lattice::FromBasis(basis), {4, 5, 6}}});
    cases.push_back({text + ", far", {*Lattice::FromBasis(basis), {4e6 + 0.3, -5e6, 6e6}}});
  }
  return cases;
}

mpq_class Position(const Grid& grid, const Int3& ijk, size_t axis) {
  mpq_class position(grid.origin[axis]);
  for (size_t m = 0; m < 3; ++m) position += mpq_class(static_cast<double>(ijk[m])) * grid.lattice.basis()[m][axis];
  return position;
}

bool IsIn(const Grid& grid, const Bounds& bounds, const Int3& ijk) {
  for (size_t axis = 0; axis < 3; ++axis) {
    const mpq_class position = Position(grid, ijk, axis);
    if (position < bounds.min[axis] || position > bounds.max[axis]) return false;
  }
  return true;
}

std::set<Int3> Filtered(const Grid& grid, const Bounds& bounds, const std::set<Int3>& voxels) {
  std::set<Int3> in;
  std::copy_if(voxels.begin(), voxels.end(), std::inserter(in, in.end()),
               [&](const Int3& ijk) { return IsIn(grid, bounds, ijk); });
  return in;
}

// Boxes with each face at the double next to the position of some voxel, or next to that.
class Boxes {
 public:
  Boxes(const Grid& grid, const std::set<Int3>& voxels)
      : grid_(grid), voxels_(voxels.begin(), voxels.end()), random_(4) {}

  Bounds Next() {
    Bounds bounds{};
    for (size_t axis = 0; axis < 3; ++axis) {
      const double a = Face(axis), b = Face(axis);
      bounds.min[axis] = std::min(a, b);
      bounds.max[axis] = std::max(a, b);
    }
    return bounds;
  }

 private:
  double Face(size_t axis) {
    const double at = Position(grid_, voxels_[random_() % voxels_.size()], axis).get_d();
    const uint64_t which = random_() % 4;
    return which == 0 ? std::nextafter(at, -kInfinity) : which == 1 ? std::nextafter(at, kInfinity) : at;
  }

  const Grid& grid_;
  const std::vector<Int3> voxels_;
  std::mt19937_64 random_;
};

TEST(Bounds, LeaveOfTheWholeWhatIsInTheBoxByRationals) {
  const TriangleMesh mesh = Sphere(12, 24);
  for (const auto& [name, grid] : Cases()) {
    const auto whole = VoxelsOf(Voxelize(mesh, grid, {}));
    Boxes boxes(grid, whole);
    size_t some = 0;
    for (int n = 0; n < 6; ++n) {
      const Bounds bounds = boxes.Next();
      const auto part = VoxelsOf(Voxelize(mesh, grid, {.bounds = bounds}, n % 2 == 0 ? 1 : 3));
      EXPECT_EQ(part, Filtered(grid, bounds, whole)) << name << ' ' << n;
      some += !part.empty() && part.size() < whole.size();
    }
    EXPECT_GE(some, 4U) << name;
  }
}

TEST(Bounds, HoldForEveryKindOfJob) {
  const TriangleMesh mesh = Sphere(8, 22);
  const Case c = Cases()[2];
  for (const VoxelizeOptions& options :
       {VoxelizeOptions{.separability = 2, .minimal = false}, VoxelizeOptions{.algorithm = Algorithm::kIncremental},
        VoxelizeOptions{.set = Solid{}}, VoxelizeOptions{.set = Solid{.surface = SolidSurface::kNone}},
        VoxelizeOptions{.set = SupercoverSurface{}},
        VoxelizeOptions{.region = IndexBox{{-20, -20, -9}, {20, 15, 50}}}}) {
    const Bounds bounds{{-11.5, -20, -12}, {22, 10.25, 17}};
    VoxelizeOptions part = options;
    part.bounds = bounds;
    const Result found = Voxelize(mesh, c.grid, part);
    const auto whole = VoxelsOf(Voxelize(mesh, c.grid, options)), expected = Filtered(c.grid, bounds, whole);
    EXPECT_EQ(VoxelsOf(found), expected);
    EXPECT_EQ(found.totals.voxels, expected.size());
    EXPECT_TRUE(!expected.empty() && expected.size() < whole.size());
  }
}

// On a skew basis most of the index box is outside.
TEST(Bounds, AreSplitIntoShardsThatCostAboutTheSame) {
  const TriangleMesh mesh = Sphere(60, 900);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kFcc));
  const Bounds bounds{{-300, -1000, -300}, {1000, 300, 1000}};
  const JobTotals whole = Voxelize(mesh, grid, {.separability = 2, .bounds = bounds}).totals;
  Digest sum;
  for (const uint32_t index : {0U, 1U, 2U}) {
    const Result part = Voxelize(mesh, grid, {.separability = 2, .bounds = bounds, .shard = Shard{index, 3}});
    EXPECT_LT(static_cast<double>(part.totals.voxels), 1.25 / 3 * static_cast<double>(whole.voxels)) << index;
    sum.Add(part.totals.digest);
  }
  EXPECT_EQ(sum, whole.digest);
}

TEST(Bounds, OfABandKeepItsDistances) {
  const TriangleMesh mesh = Sphere(8, 40);
  const Case c = Cases()[3];
  const auto distances = [&](const VoxelizeOptions& options) {
    return DistancesOf(Voxelize(mesh, c.grid, options).tiles);
  };
  const VoxelizeOptions band{.set = Band{2, true}, .fields = {Field::kDistance}, .signed_distance = true};
  std::map<Vec3i, float> whole = distances(band);
  const Bounds bounds{{-10, -60, -20.5}, {50, 0, 33}};
  VoxelizeOptions part = band;
  part.bounds = bounds;
  std::erase_if(whole, [&](const auto& voxel) {
    return !IsIn(c.grid, bounds, {voxel.first[0], voxel.first[1], voxel.first[2]});
  });
  EXPECT_EQ(distances(part), whole);
  EXPECT_GT(whole.size(), 1000U);
}

TEST(Bounds, MakeTheWholeAndResumeLikeIt) {
  const TriangleMesh mesh = Sphere(30, 170);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kBcc));
  const double big = 1e300;
  std::set<Int3> both;
  size_t voxels = 0;
  for (const Bounds& bounds :
       {Bounds{{-big, -big, -big}, {std::nextafter(0, -1), big, big}}, Bounds{{0, -big, -big}, {big, big, big}}}) {
    const Result part = Voxelize(mesh, grid, {.bounds = bounds});
    both.merge(VoxelsOf(part));
    voxels += part.totals.voxels;
    ASSERT_GT(part.tiles.size(), 4U);
    const Vec3i& tile = part.tiles[2].tile_ijk;
    const Result rest = Voxelize(mesh, grid, {.bounds = bounds, .resume_after = tile});
    ASSERT_EQ(rest.tiles.size(), part.tiles.size() - 3);
    EXPECT_EQ(rest.tiles[0].tile_ijk, part.tiles[3].tile_ijk);
    for (const TileBricks& t : part.tiles) {
      EXPECT_FALSE(t.bricks.empty());
      for (const Brick& brick : t.bricks) EXPECT_GT(CountVoxels(brick.mask), 0U);
    }
  }
  EXPECT_EQ(both, VoxelsOf(Voxelize(mesh, grid, {})));
  EXPECT_EQ(both.size(), voxels);
}

absl::StatusOr<JobFacts> FactsFor(const TriangleMesh& mesh, const Grid& grid, const Bounds& bounds) {
  const auto job = VoxelizeJob::Create(mesh, grid, {.bounds = bounds});
  if (!job.ok()) return job.status();
  return (*job)->facts();
}

TEST(Bounds, NarrowTheIndexBoxOnEveryBasis) {
  const TriangleMesh mesh = Sphere(20, 200);
  for (const auto& [name, grid] : Cases()) {
    const Bounds bounds{{100, 100, 100}, {107, 107, 107}};
    const auto facts = FactsFor(mesh, grid, bounds);
    ASSERT_TRUE(facts.ok() && facts->index_box) << name << facts.status();
    EXPECT_TRUE(facts->cut_by_bounds);
    // Two points of the box lie within 7 * sqrt(3) of each other, whatever the basis.
    for (size_t m = 0; m < 3; ++m) {
      double row = 0;
      for (const Vec3d& column : grid.lattice.inverse()) row += column[m] * column[m];
      EXPECT_LE(facts->index_box->max[m] - facts->index_box->min[m], 7 * std::sqrt(3 * row) + 2) << name;
    }
    EXPECT_LT(EstimateVoxels(mesh, ExtentOf(mesh), grid, {.part = {.bounds = bounds}}), 9000) << name;
  }
}

TEST(Bounds, ThatHoldAllOrNothingAreNoErrors) {
  const TriangleMesh mesh = Sphere(10, 20);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kFcc));
  const double most = std::numeric_limits<double>::max();
  const Bounds all{{-most, -most, -most}, {most, most, most}};
  EXPECT_FALSE(FactsFor(mesh, grid, all)->cut_by_bounds);
  EXPECT_EQ(Voxelize(mesh, grid, {.bounds = all}).totals.digest, Voxelize(mesh, grid, {}).totals.digest);
  for (const Bounds& none : {Bounds{{1000, 0, 0}, {2000, 1, 1}}, Bounds{{-most, 21, 0}, {most, 21, 0}},
                             Bounds{{5e-324, 5e-324, 5e-324}, {5e-324, 5e-324, 5e-324}}}) {
    EXPECT_TRUE(Voxelize(mesh, grid, {.bounds = none}).tiles.empty());
  }
  EXPECT_FALSE(FactsFor(mesh, grid, {{1000, 0, 0}, {2000, 1, 1}})->index_box);
}

TEST(Bounds, AreRefusedUnlessFiniteAndInOrder) {
  const TriangleMesh mesh = Sphere(4, 20);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  for (const Bounds& bounds : {Bounds{{0, 1, 0}, {1, 0.5, 1}}, Bounds{{0, 0, std::nan("")}, {1, 1, 1}},
                               Bounds{{0, 0, 0}, {kInfinity, 1, 1}}}) {
    const auto job = VoxelizeJob::Create(mesh, grid, {.bounds = bounds});
    ASSERT_FALSE(job.ok());
    EXPECT_EQ(job.status().message().substr(0, 7), "bounds.");
  }
}

// Numbers of all sizes, and boxes of points next to the faces.
TEST(WorldBox, ComparesLikeRationals) {
  std::mt19937_64 random(5);
  const auto number = [&](int least, int most) {
    const double mantissa = static_cast<double>(static_cast<int64_t>(random() >> 11)) * (random() % 2 == 0 ? 1 : -1);
    return std::ldexp(mantissa, std::uniform_int_distribution(least, most)(random));
  };
  size_t in = 0;
  for (int n = 0; n < 2000; ++n) {
    const bool wild = n % 2 == 0;
    Mat3d basis{};
    for (size_t m = 0; m < 3; ++m) basis[m][m] = std::abs(number(-53, -52)) + 0.5;
    basis[1][0] = number(-56, -54);
    const auto lattice = Lattice::FromBasis(basis);
    ASSERT_TRUE(lattice.ok()) << lattice.status();
    Grid grid{*lattice, {}};
    for (double& x : grid.origin) x = wild ? number(-1100, 900) : number(-53, -40);
    Vec3i ijk;
    for (int32_t& x : ijk) x = static_cast<int32_t>(random() % (1 << 30)) - (1 << 29);
    const Int3 point{ijk[0], ijk[1], ijk[2]};
    Bounds bounds{};
    for (size_t axis = 0; axis < 3; ++axis) {
      const double at = Position(grid, point, axis).get_d();  // towards 0
      bounds.min[axis] = n % 3 == 0 ? at : std::nextafter(at, -kInfinity);
      bounds.max[axis] = n % 5 == 0 ? bounds.min[axis] : std::nextafter(at, kInfinity);
    }
    const WorldBox box(grid, bounds);
    EXPECT_EQ(box.Contains(ijk), IsIn(grid, bounds, point)) << n;
    in += box.Contains(ijk);
    const IndexBox one{ijk, ijk + Vec3i{1, 1, 1}};
    EXPECT_EQ(box.ContainsAll(one), box.Contains(ijk));
    EXPECT_NE(box.Misses(one), box.Contains(ijk));
    const Vec3i some{7, 7, 7};
    EXPECT_TRUE(!box.Contains(ijk) || box.Around({ijk - some, ijk + some}).Contains(ijk)) << n;
  }
  EXPECT_GT(in, 400U);
  EXPECT_LT(in, 1900U);
}

}  // namespace
}  // namespace latvox
