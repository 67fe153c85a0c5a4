// The thesis's algorithms triangle by triangle, compared with its theorems and the exact oracle's planes.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

#include "core/base/stop_signal.h"
#include "core/thesis/active_edge_table.h"
#include "core/thesis/brute_force.h"
#include "core/thesis/degenerate.h"
#include "core/thesis/incremental.h"
#include "core/thesis/seams.h"
#include "tests/unit/core/exact.h"

namespace latvox {
namespace {

using oracle::Int3;

std::vector<int> DistinctK(const Lattice& lattice) {
  std::vector<int> ks{0};
  for (int k : {1, 2}) {
    if (lattice.frames(k).size() != lattice.frames(k - 1).size()) ks.push_back(k);
  }
  return ks;
}

// Every kind of lattice, including those that floats cannot hold exactly.
std::vector<ExactLattice> AllLattices() {
  std::vector<ExactLattice> all = ExactLattices();
  for (NamedLattice name :
       {NamedLattice::kCartesian, NamedLattice::kBcc, NamedLattice::kFcc, NamedLattice::kHexagonal}) {
    const Lattice lattice = Lattice::Named(name);
    all.push_back({"unit " + std::string(lattice.name()), lattice});
  }
  return all;
}

std::set<Int3> BruteForceIn(const oracle::Triangle& t, const Neighborhood& neighborhood, const oracle::Box& box) {
  Triangle triangle;
  for (size_t n = 0; n < 3; ++n) {
    for (size_t m = 0; m < 3; ++m) triangle[n][m] = static_cast<int32_t>(t[n][m]);
  }
  std::set<Int3> voxels;
  BruteForceTriangle(triangle, neighborhood, StopSignal(), [&](const Vec3i& z) {
    if (box.Contains(ToOracle(z))) voxels.insert(ToOracle(z));
  });
  return voxels;
}

// Normals along, between and far from lattice directions, with many points exactly at +-t.
std::vector<Int3> Normals(std::mt19937& random) {
  std::vector<Int3> normals{{1, 0, 0}, {0, 1, 0}, {0, 0, 1},  {1, 1, 0},  {1, -1, 0}, {1, 1, 1},
                            {1, 1, 2}, {1, 2, 3}, {-1, 2, 2}, {1, 0, -2}, {2, 1, 0},  {1, 1, -1}};
  std::uniform_int_distribution<int> component(-4, 4);
  for (int n = 0; n < 6; ++n) normals.push_back({component(random), 1, component(random)});
  return normals;
}

TEST(BruteForce, IsTheoremFoursSetInTheMiddleOfABigTriangle) {
  constexpr unsigned kSeed = 11;
  std::mt19937 random(kSeed);
  for (const ExactLattice& l : ExactLattices()) {
    for (int k : DistinctK(l.lattice)) {
      const Neighborhood neighborhood(l.lattice, k);
      for (const Int3& normal : Normals(random)) {
        for (int64_t offset : {int64_t{0}, int64_t{128}, static_cast<int64_t>(random() % 2048)}) {
          const oracle::Triangle triangle = oracle::PlaneQuad(normal, offset, 28 * 256)[0];
          oracle::Box box;
          for (size_t m = 0; m < 3; ++m) {
            const int64_t middle = (triangle[0][m] + triangle[1][m] + triangle[2][m]) / (3 * 256);
            box.lo[m] = middle - 3;
            box.hi[m] = middle + 3;
          }
          const auto expected = oracle::PlaneSet(normal, offset, Directions(l.lattice.frames(k)), box);
          ASSERT_FALSE(expected.empty());
          ASSERT_EQ(BruteForceIn(triangle, neighborhood, box), expected)
              << l.name << " k " << k << " normal " << normal[0] << "," << normal[1] << "," << normal[2] << " offset "
              << offset << " seed " << kSeed;
        }
      }
    }
  }
}

TEST(BruteForce, OfAPointIsTheClosedBallOfRadiusR) {
  for (const ExactLattice& l : AllLattices()) {
    for (int k : DistinctK(l.lattice)) {
      const Neighborhood neighborhood(l.lattice, k);
      const Vec3i point{100, -30, 77};
      std::set<Int3> expected;
      for (int n = 0; n < 729; ++n) {
        const Vec3i z{n / 81 - 4, n / 9 % 9 - 4, n % 9 - 4};
        const Vec3d d = Apply(l.lattice.basis(), ToDouble(z) - ToDouble(point) * (1.0 / 256));
        if (std::sqrt(Dot(d, d)) <= neighborhood.radius * (1 + 1e-12)) expected.insert(ToOracle(z));
      }
      std::set<Int3> voxels;
      BruteForceTriangle({point, point, point}, neighborhood, StopSignal(),
                         [&](const Vec3i& z) { voxels.insert(ToOracle(z)); });
      EXPECT_EQ(voxels, expected) << l.name << " k " << k;
    }
  }
}

TEST(BruteForce, HoldsBothEndsOfAnEdgeOfLengthTwoRHalvedByAVertex) {
  for (const ExactLattice& l : AllLattices()) {
    for (int k : DistinctK(l.lattice)) {
      const Neighborhood neighborhood(l.lattice, k);
      for (const Frame& frame : l.lattice.frames(k)) {
        const Vec3d step = Apply(l.lattice.basis(), frame.q);
        if (std::sqrt(Dot(step, step)) < 2 * neighborhood.radius * (1 - 1e-9)) continue;
        const Vec3i half = frame.q * (kLatticeUnit / 2);
        std::set<Vec3i> voxels;
        BruteForceTriangle({half, half, half}, neighborhood, StopSignal(), [&](const Vec3i& z) { voxels.insert(z); });
        EXPECT_TRUE(voxels.contains(Vec3i{}) && voxels.contains(frame.q)) << l.name << " k " << k;
      }
    }
  }
}

TEST(ActiveEdgeTable, YieldsExactlyThePointsInsideOrOnTheBorder) {
  constexpr unsigned kSeed = 3;
  std::mt19937 random(kSeed);
  using Point = ActiveEdgeTable::Point;
  for (int round = 0; round < 2000; ++round) {
    std::array<Point, 3> v;
    for (Point& p : v) p = {static_cast<int64_t>(random() % 15) - 7, static_cast<int64_t>(random() % 15) - 7};
    const auto side = [&](size_t n, const Point& p) {
      const Point& a = v[n];
      const Point& b = v[(n + 1) % 3];
      return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
    };
    const int64_t area = side(0, v[2]);
    if (area == 0) continue;
    std::set<Point> expected, scanned;
    for (int64_t i = -8; i <= 8; ++i) {
      for (int64_t j = -8; j <= 8; ++j) {
        bool in = true;
        for (size_t n = 0; n < 3; ++n) in &= (area > 0 ? side(n, {i, j}) : -side(n, {i, j})) >= 0;
        if (in) expected.insert({i, j});
      }
    }
    for (ActiveEdgeTable row(v); !row.done(); row.NextRow()) {
      for (int64_t i = row.first(); i <= row.last(); ++i) EXPECT_TRUE(scanned.insert({i, row.j()}).second);
    }
    ASSERT_EQ(scanned, expected) << "round " << round << " seed " << kSeed;
  }
}

TEST(NearestLatticePoint, IsNoFartherThanAnyOther) {
  constexpr unsigned kSeed = 8;
  std::mt19937 random(kSeed);
  for (const ExactLattice& l : AllLattices()) {
    for (int round = 0; round < 500; ++round) {
      Vec3d point;
      for (double& x : point) x = static_cast<double>(random() % 2048) / 256 - 4;
      const auto distance = [&](const Vec3i& z) {
        const Vec3d d = Apply(l.lattice.basis(), point - ToDouble(z));
        return Dot(d, d);
      };
      const Vec3i nearest = NearestLatticePoint(l.lattice, point);
      for (int n = 0; n < 729; ++n) {
        const Vec3i other = nearest + Vec3i{n / 81 - 4, n / 9 % 9 - 4, n % 9 - 4};
        ASSERT_LE(distance(nearest), distance(other)) << l.name << " seed " << kSeed;
      }
      EXPECT_LE(std::sqrt(distance(nearest)), Neighborhood(l.lattice, 0).covering_radius_max * (1 + 1e-12));
    }
  }
}

std::vector<VoxelTriangle> RandomTriangles(unsigned seed, int32_t reach, int count) {
  std::mt19937 random(seed);
  std::vector<VoxelTriangle> triangles;
  while (triangles.size() < static_cast<size_t>(count)) {
    VoxelTriangle t;
    const bool flat = triangles.size() % 3 == 0;  // few distinct coordinates: many ties
    for (Vec3i& v : t) {
      for (int32_t& x : v) x = static_cast<int32_t>(random() % static_cast<unsigned>(2 * reach + 1)) - reach;
      if (flat) v[random() % 3] &= ~7;
    }
    if (NormalOf(t) != Vec<int64_t, 3>{}) triangles.push_back(t);
  }
  return triangles;
}

// The lattice line along q through z, in the frame of q.
ActiveEdgeTable::Point LineOf(const Frame& frame, const Vec3i& z) { return {Dot(frame.r[0], z), Dot(frame.r[1], z)}; }

std::set<ActiveEdgeTable::Point> LinesThrough(const VoxelTriangle& triangle, const Frame& frame) {
  std::set<ActiveEdgeTable::Point> lines;
  for (ActiveEdgeTable row({LineOf(frame, triangle[0]), LineOf(frame, triangle[1]), LineOf(frame, triangle[2])});
       !row.done(); row.NextRow()) {
    for (int64_t i = row.first(); i <= row.last(); ++i) lines.insert({i, row.j()});
  }
  return lines;
}

TEST(Incremental, HasExactlyTheTheoremsVoxelOnEveryLineAlongThePrincipalDirection) {
  constexpr unsigned kSeed = 21;
  for (const ExactLattice& l : ExactLattices()) {
    for (int k : DistinctK(l.lattice)) {
      const auto& frames = l.lattice.frames(k);
      for (const VoxelTriangle& triangle : RandomTriangles(kSeed, 8, 40)) {
        const auto normal = NormalOf(triangle);
        const Frame& frame = PrincipalFrame(frames, normal);
        const auto lines = LinesThrough(triangle, frame);
        const Int3 covector{normal[0], normal[1], normal[2]};
        const int64_t offset = 256 * Dot(normal, triangle[0]);
        std::set<Int3> expected;
        for (const Int3& z : oracle::PlaneSet(covector, offset, Directions(frames), {{-14, -14, -14}, {14, 14, 14}})) {
          const Vec3i ijk{static_cast<int32_t>(z[0]), static_cast<int32_t>(z[1]), static_cast<int32_t>(z[2])};
          if (lines.contains(LineOf(frame, ijk))) expected.insert(z);
        }
        EXPECT_EQ(expected.size(), lines.size());
        std::set<Int3> voxels;
        IncrementalTriangle(triangle, frames, StopSignal(), [&](const Vec3i& z) {
          EXPECT_TRUE(voxels.insert(ToOracle(z)).second) << "a voxel set twice";
        });
        ASSERT_EQ(voxels, expected) << l.name << " k " << k << " seed " << kSeed;
      }
    }
  }
}

TEST(OptimizedIncremental, DiffersFromIncrementalOnlyInVoxelsExactlyHalfWay) {
  constexpr unsigned kSeed = 22;
  uint64_t voxels = 0, halves = 0, differing = 0;
  for (const ExactLattice& l : AllLattices()) {
    for (int k : DistinctK(l.lattice)) {
      const auto& frames = l.lattice.frames(k);
      for (const VoxelTriangle& triangle : RandomTriangles(kSeed, 120, 12)) {
        const auto normal = NormalOf(triangle);
        const Frame& frame = PrincipalFrame(frames, normal);
        const int64_t two_t = std::abs(Dot(normal, frame.q));
        std::map<ActiveEdgeTable::Point, Vec3i> plain, optimized;
        IncrementalTriangle(triangle, frames, StopSignal(), [&](const Vec3i& z) { plain[LineOf(frame, z)] = z; });
        OptimizedIncrementalTriangle(triangle, frames, StopSignal(), [&](const Vec3i& z) {
          EXPECT_TRUE(optimized.emplace(LineOf(frame, z), z).second) << "two voxels on a line";
        });
        ASSERT_EQ(plain.size(), optimized.size());
        for (const auto& [line, z] : plain) {
          const bool half = 2 * std::abs(Dot(normal, z - triangle[0])) == two_t;
          ++voxels;
          halves += half;
          differing += optimized[line] != z;
          ASSERT_TRUE(half || optimized[line] == z) << l.name << " k " << k << " seed " << kSeed;
        }
      }
    }
  }
  EXPECT_GT(halves, 0U);
  std::printf("%zu voxels, %zu exactly half way, %zu of them decided otherwise by accumulated rounding\n",
              static_cast<size_t>(voxels), static_cast<size_t>(halves), static_cast<size_t>(differing));
}

// ---- Degenerate triangles -------------------------------------------------------------------------------------------

std::vector<Vec3i> Line(const LineTracer& tracer, const Vec3i& a, const Vec3i& b) {
  std::vector<Vec3i> line;
  tracer.Trace(a, b, [&](const Vec3i& z) { line.push_back(z); });
  return line;
}

TEST(LineTracer, WalksFromEndToEndByNeighborsWithinTwoRadiiEitherWay) {
  for (const ExactLattice& l : AllLattices()) {
    for (int k : DistinctK(l.lattice)) {
      const Neighborhood neighborhood(l.lattice, k);
      const LineTracer tracer(neighborhood);
      std::set<Vec3i> steps;
      for (const Frame& frame : l.lattice.frames(k)) {
        steps.insert(frame.q);
        steps.insert(-frame.q);
      }
      const Vec3i a{5, -3, 100};
      for (int n = 0; n < 2197; ++n) {
        const Vec3i b = a + Vec3i{n / 169 - 6, n / 13 % 13 - 6, n % 13 - 6} * (n % 7 == 0 ? 9 : 1);
        const std::vector<Vec3i> line = Line(tracer, a, b);
        EXPECT_EQ(line.front(), std::min(a, b));
        EXPECT_EQ(line.back(), std::max(a, b));
        const Vec3d along = Apply(l.lattice.basis(), b - a);
        for (size_t s = 1; s < line.size(); ++s) {
          ASSERT_TRUE(steps.contains(line[s] - line[s - 1])) << l.name << " k " << k;
          const Vec3d area = Cross(Apply(l.lattice.basis(), line[s] - a), along);
          ASSERT_LE(std::sqrt(Dot(area, area)), 2 * neighborhood.radius * std::sqrt(Dot(along, along)) + 1e-9)
              << l.name << " k " << k;
        }
        ASSERT_EQ(line, Line(tracer, b, a));
      }
    }
  }
}

TEST(LineTracer, IsBresenhamsLineOnTheCartesianLattice) {
  const Lattice cartesian = ExactLattices()[0].lattice;
  const LineTracer k0(Neighborhood(cartesian, 0)), k2(Neighborhood(cartesian, 2));
  for (int n = 0; n < 2197; ++n) {
    const Vec3i b{n / 169 - 6, n / 13 % 13 - 6, n % 13 - 6};
    const Vec3i size{std::abs(b[0]), std::abs(b[1]), std::abs(b[2])};
    EXPECT_EQ(Line(k0, {}, b).size(), static_cast<size_t>(std::max({size[0], size[1], size[2]})) + 1);
    EXPECT_EQ(Line(k2, {}, b).size(), static_cast<size_t>(size[0] + size[1] + size[2]) + 1);
  }
  EXPECT_EQ(Line(k0, {}, {4, 2, 0}), (std::vector<Vec3i>{{0, 0, 0}, {1, 0, 0}, {2, 1, 0}, {3, 1, 0}, {4, 2, 0}}));
}

TEST(DegenerateTriangle, IsAVoxelOrTheLineBetweenItsOutermostVertices) {
  for (const ExactLattice& l : AllLattices()) {
    const LineTracer tracer(Neighborhood(l.lattice, 0));
    const auto voxels = [&](const VoxelTriangle& triangle) {
      std::set<Vec3i> set;
      DegenerateTriangle(triangle, tracer, [&](const Vec3i& z) { set.insert(z); });
      return set;
    };
    const Vec3i a{1, 2, 3}, b{7, -1, 6}, middle{3, 1, 4};
    EXPECT_EQ(voxels({a, a, a}), std::set<Vec3i>{a});
    const auto line = Line(tracer, a, b);
    const std::set<Vec3i> expected(line.begin(), line.end());
    EXPECT_EQ(voxels({a, b, a}), expected);
    EXPECT_EQ(voxels({b, b, a}), expected);
    EXPECT_EQ(voxels({middle, b, a}), expected);
    EXPECT_EQ(voxels({b, a, middle}), expected);
  }
}

// ---- Seams ----------------------------------------------------------------------------------------------------------

TEST(Seam, IsEveryVoxelNearTheEdgeInTheSlabsOfAllItsTriangles) {
  constexpr unsigned kSeed = 31;
  std::mt19937 random(kSeed);
  for (const ExactLattice& l : ExactLattices()) {
    for (int k : DistinctK(l.lattice)) {
      const Neighborhood neighborhood(l.lattice, k);
      for (int round = 0; round < 20; ++round) {
        std::vector<Vec3i> points;
        for (int n = 0; n < 4; ++n) {
          Vec3i p;
          for (int32_t& x : p) x = static_cast<int32_t>(random() % 9) - 4;
          points.push_back(p);
        }
        const Vec3i &a = points[0], &b = points[1];
        std::vector<Vec<int64_t, 3>> normals{NormalOf({a, b, points[2]}), NormalOf({a, b, points[3]})};
        if (normals[0] == Vec<int64_t, 3>{} || normals[1] == Vec<int64_t, 3>{}) continue;
        std::set<Int3> expected;
        const Tube tube(neighborhood, ToDouble(a), ToDouble(b));
        for (int n = 0; n < 21 * 21 * 21; ++n) {
          const Vec3i z{n / 441 - 10, n / 21 % 21 - 10, n % 21 - 10};
          bool in_all = tube.Contains(ToDouble(z)), in_one = false;
          for (const auto& normal : normals) {
            int64_t two_t = 0;
            for (const Frame& frame : l.lattice.frames(k)) two_t = std::max(two_t, std::abs(Dot(normal, frame.q)));
            const int64_t twice = 2 * Dot(normal, z - a);
            in_all &= -two_t <= twice && twice <= two_t;
            in_one |= -two_t < twice && twice <= two_t;
          }
          if (in_all && in_one) expected.insert(ToOracle(z));
        }
        std::set<Int3> voxels;
        Seam(a, b, normals, neighborhood, StopSignal(), [&](const Vec3i& z) { voxels.insert(ToOracle(z)); });
        ASSERT_EQ(voxels, expected) << l.name << " k " << k << " round " << round << " seed " << kSeed;
      }
    }
  }
}

}  // namespace
}  // namespace latvox
