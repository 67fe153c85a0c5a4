// The crossing rule equals the exact oracle, and the thesis's theorems hold, ties included.
#include "core/digitize/crossing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <random>

#include "core/supercover/cut_triangle.h"
#include "tests/unit/core/exact.h"

namespace latvox {
namespace {

constexpr int32_t kFar = 1 << 20;
constexpr IndexBox kEverywhere{{-kFar, -kFar, -kFar}, {kFar, kFar, kFar}};

using Ends = std::pair<oracle::Int3, oracle::Int3>;  // nearer, farther

Triangle ToCore(const oracle::Triangle& triangle) {
  Triangle out;
  for (size_t n = 0; n < 3; ++n) {
    for (size_t m = 0; m < 3; ++m) out[n][m] = static_cast<int32_t>(triangle[n][m]);
  }
  return out;
}

IndexBox ToCore(const oracle::Box& box) {
  IndexBox out;
  for (size_t m = 0; m < 3; ++m) {
    out.min[m] = static_cast<int32_t>(box.lo[m]);
    out.max[m] = static_cast<int32_t>(box.hi[m] + 1);
  }
  return out;
}

std::map<Ends, int> CoreCrossings(const oracle::Mesh& mesh, const Frame& frame, const IndexBox& box) {
  std::map<Ends, int> crossings;
  for (const oracle::Triangle& triangle : mesh) {
    ForEachCrossing(ToCore(triangle), frame, box, [&](const Vec3i& nearer, const Vec3i& farther) {
      ++crossings[{ToOracle(nearer), ToOracle(farther)}];
    });
  }
  return crossings;
}

std::map<Ends, int> OracleCrossings(const oracle::Mesh& mesh, const Frame& frame,
                                    const std::optional<oracle::Box>& box) {
  std::map<Ends, int> crossings;
  for (const oracle::Crossing& crossing : oracle::Crossings(mesh, ToOracle(frame.q), box)) {
    if (!box || box->Contains(crossing.near_end)) ++crossings[{crossing.near_end, crossing.far_end}];
  }
  return crossings;
}

TEST(CrossingRule, EqualsTheOracleOnAdversarialMeshesInEveryDirection) {
  for (const ExactLattice& l : ExactLattices()) {
    for (uint64_t seed : {1, 2}) {
      const auto& frames = l.lattice.frames(0);
      for (const auto& mesh : oracle::AdversarialMeshes(seed, Directions(frames))) {
        const IndexBox box = mesh.box ? ToCore(*mesh.box) : kEverywhere;
        for (const Frame& frame : frames) {
          ASSERT_EQ(CoreCrossings(mesh.triangles, frame, box), OracleCrossings(mesh.triangles, frame, mesh.box))
              << l.name << " seed " << seed << " " << mesh.name << " q " << frame.q[0] << "," << frame.q[1] << ","
              << frame.q[2];
        }
      }
    }
  }
}

TEST(CrossingRule, EqualsTheOracleForOneTriangleAtTheLimitsOfTheWidths) {
  constexpr unsigned kSeed = 3;
  std::mt19937 random(kSeed);
  constexpr int64_t kTop = int64_t{kMaxExtent} * kLatticeUnit;
  std::uniform_int_distribution<int64_t> coordinate(0, kTop);
  for (const ExactLattice& l : ExactLattices()) {
    for (int n = 0; n < 40; ++n) {
      oracle::Triangle triangle;
      for (auto& v : triangle) {
        for (auto& x : v) x = n % 2 == 0 ? coordinate(random) : coordinate(random) < kTop / 2 ? 0 : kTop;
      }
      oracle::Int3 middle;  // a point of the triangle, so that the box is crossed
      for (size_t m = 0; m < 3; ++m) middle[m] = (triangle[0][m] + triangle[1][m] + 2 * triangle[2][m]) / 4 / 256;
      const oracle::Box box = oracle::Box{middle, middle}.Grown({2, 2, 2});
      for (const Frame& frame : l.lattice.frames(0)) {
        ASSERT_EQ(CoreCrossings({triangle}, frame, ToCore(box)), OracleCrossings({triangle}, frame, box))
            << l.name << " seed " << kSeed << " triangle " << n;
      }
    }
  }
}

TEST(CrossingRule, DoesNotDependOnTheBoxNorOnTheOrderOfVertices) {
  const auto frames = ExactLattices()[1].lattice.frames(0);
  for (const auto& mesh : oracle::AdversarialMeshes(5, Directions(frames))) {
    if (mesh.box) continue;
    oracle::Mesh turned;
    for (const auto& t : mesh.triangles) turned.push_back({t[1], t[2], t[0]});
    oracle::Mesh flipped;
    for (const auto& t : mesh.triangles) flipped.push_back({t[1], t[0], t[2]});
    const IndexBox part{{-3, -2, 0}, {2, 5, 4}};
    for (const Frame& frame : frames) {
      auto whole = CoreCrossings(mesh.triangles, frame, kEverywhere);
      EXPECT_EQ(whole, CoreCrossings(turned, frame, kEverywhere)) << mesh.name;
      EXPECT_EQ(whole, CoreCrossings(flipped, frame, kEverywhere)) << mesh.name;
      std::erase_if(whole, [&](const auto& entry) {
        const oracle::Int3& z = entry.first.first;
        return !part.Contains({static_cast<int32_t>(z[0]), static_cast<int32_t>(z[1]), static_cast<int32_t>(z[2])});
      });
      EXPECT_EQ(whole, CoreCrossings(mesh.triangles, frame, part)) << mesh.name;
    }
  }
}

// The voxels of a large triangle pair in the plane, near its middle.
std::set<oracle::Int3> DigitizedPlane(const oracle::Int3& normal, int64_t offset, const std::vector<Frame>& frames,
                                      const oracle::Box& box) {
  std::set<oracle::Int3> voxels;
  for (const Frame& frame : frames) {
    for (const auto& [ends, count] : CoreCrossings(oracle::PlaneQuad(normal, offset, 80 * 256), frame, ToCore(box))) {
      voxels.insert(ends.first);
    }
  }
  return voxels;
}

// { z : -t < n.z - offset/256 <= t } with 2t = width, n turned so that its first nonzero entry is positive.
std::set<oracle::Int3> Slab(oracle::Int3 n, int64_t offset, int64_t width, const oracle::Box& box) {
  if (!FirstNonzeroIsPositive(n)) {
    for (auto& x : n) x = -x;
    offset = -offset;
  }
  std::set<oracle::Int3> voxels;
  for (int64_t i = box.lo[0]; i <= box.hi[0]; ++i) {
    for (int64_t j = box.lo[1]; j <= box.hi[1]; ++j) {
      for (int64_t k = box.lo[2]; k <= box.hi[2]; ++k) {
        const int64_t d2 = 2 * (256 * (n[0] * i + n[1] * j + n[2] * k) - offset);
        if (-256 * width < d2 && d2 <= 256 * width) voxels.insert({i, j, k});
      }
    }
  }
  return voxels;
}

// Normals in lattice coordinates with an entry +-1, as PlaneQuad needs them.
std::vector<oracle::Int3> Normals() {
  return {{1, 0, 0},   {0, 1, 0},   {0, 0, 1}, {1, 1, 0},  {1, -1, 0}, {0, 1, 1},   {1, 1, 1},
          {1, -1, 1},  {-1, 1, 1},  {2, 1, 0}, {1, 2, 3},  {-3, 1, 2}, {5, 1, -4},  {1, 7, -2},
          {-1, -1, 6}, {2, -1, -1}, {1, 1, 2}, {1, -2, 1}, {4, 1, 11}, {13, -5, 1}, {-1, 17, 23}};
}

constexpr oracle::Box kPlaneBox{{-5, -5, -5}, {5, 5, 5}};
const int64_t kOffsets[] = {0, 128, 256, -128, 64, 1, -77, 384, 127, 129};  // multiples of 128 make depth ties

TEST(CrossingRule, EqualsTheoremsFiveSixAndSevenOnCartesianPlanes) {
  const Lattice lattice = ExactLattices()[0].lattice;
  for (const auto& n : Normals()) {
    std::array<int64_t, 3> a{std::abs(n[0]), std::abs(n[1]), std::abs(n[2])};
    std::sort(a.begin(), a.end());
    const int64_t width[3] = {a[0] + a[1] + a[2], a[1] + a[2], a[2]};  // 2t of Theorems 5, 7, 6, times |n|
    for (int k = 0; k < 3; ++k) {
      for (int64_t offset : kOffsets) {
        EXPECT_EQ(DigitizedPlane(n, offset, lattice.frames(k), kPlaneBox), Slab(n, offset, width[k], kPlaneBox))
            << "k " << k << " normal " << n[0] << "," << n[1] << "," << n[2] << " offset " << offset;
      }
    }
  }
}

TEST(CrossingRule, EqualsTheoremFourOnBccPlanes) {
  const Lattice lattice = ExactLattices()[1].lattice;
  for (const auto& n : Normals()) {
    // n = V^T N: the world normal N, doubled, from the covector in lattice coordinates.
    const int64_t x = n[0], y = n[1], z = 2 * n[2] - n[0] - n[1];
    const int64_t three = 2 * std::max({std::abs(x), std::abs(y), std::abs(z)});  // 2 d_3 cos: steps (2,0,0)
    const int64_t four = std::abs(x) + std::abs(y) + std::abs(z);                 // 2 d_4 cos: steps (1,1,1)
    for (int64_t offset : kOffsets) {
      // N is doubled, so the slab is that of 2n.
      EXPECT_EQ(DigitizedPlane(n, offset, lattice.frames(0), kPlaneBox),
                Slab({2 * n[0], 2 * n[1], 2 * n[2]}, 2 * offset, std::max(three, four), kPlaneBox))
          << "normal " << n[0] << "," << n[1] << "," << n[2] << " offset " << offset;
    }
  }
}

TEST(CrossingRule, EqualsTheGeneralPlaneOnEveryLattice) {
  for (const ExactLattice& l : ExactLattices()) {
    for (int k = 0; k < 3; ++k) {
      const auto& frames = l.lattice.frames(k);
      for (const auto& n : Normals()) {
        for (int64_t offset : kOffsets) {
          EXPECT_EQ(DigitizedPlane(n, offset, frames, kPlaneBox),
                    oracle::PlaneSet(n, offset, Directions(frames), kPlaneBox))
              << l.name << " k " << k << " normal " << n[0] << "," << n[1] << "," << n[2] << " offset " << offset;
        }
      }
    }
  }
}

// Points of triangles of all sizes and shapes, needles above all, that lie between planes, are not cut off; and little
// else is left.
TEST(CutTriangle, IsWhatLiesBetweenPlanes) {
  std::mt19937 random(12);
  std::uniform_real_distribution<double> any(0, 1);
  for (int n = 0; n < 20000; ++n) {
    const auto size = static_cast<int32_t>(std::pow(2.0, 2 + 22 * any(random)));
    const auto width = static_cast<int32_t>(n % 3 == 0 ? 2 : size);
    std::uniform_int_distribution<int32_t> far(-size, size), near(-width, width);
    Triangle t;
    for (size_t m = 0; m < 3; ++m) {
      t[0][m] = far(random);
      t[1][m] = far(random);
      t[2][m] = t[n % 2][m] + near(random);
    }
    const Vec3d a = ToDouble(t[0]), u = ToDouble(t[1]) - a, v = ToDouble(t[2]) - a;
    double x = any(random), y = any(random);
    if (x + y > 1) {
      x = 1 - x;
      y = 1 - y;
    }
    const Vec3d point = a + u * x + v * y;
    const size_t first = random() % 3, second = (first + 1 + random() % 2) % 3, third = 3 - first - second;
    const double half = 300 * any(random);
    const auto cut = [&](const CutTriangle& part, size_t axis) {
      return part.Between(axis, point[axis] - half, point[axis] + half);
    };
    const CutTriangle once = cut(CutTriangle(t), first), twice = cut(once, second);
    for (const CutTriangle& part : {once, twice}) {
      const auto [low, high] = part.Along(third);
      EXPECT_LE(low, point[third]) << n;
      EXPECT_GE(high, point[third]) << n;
    }
    const auto [low, high] = twice.Along(first);
    EXPECT_GE(low, point[first] - half - 2.01);
    EXPECT_LE(high, point[first] + half + 2.01);
    const auto beyond = static_cast<double>(std::max({t[0][first], t[1][first], t[2][first]})) + 2;
    const auto [from, to] = CutTriangle(t).Between(first, beyond, beyond + half).Along(second);
    EXPECT_GT(from, to);
  }
}

TEST(ForEachRowNear, HasAllVoxelsWithinTheMarginAndFewOthersOfANeedle) {
  std::mt19937 random(13);
  std::uniform_real_distribution<double> any(0, 1);
  for (int n = 0; n < 3000; ++n) {
    const int32_t size = 1 << (6 + n % 12), width = n % 2 == 0 ? 3 : size;
    std::uniform_int_distribution<int32_t> far(-size, size), near(-width, width);
    Triangle t;
    Vec3d point;
    const double x = any(random), y = (1 - x) * any(random);
    const Vec3i margin{100 + n % 900, 100 + n % 700, 100 + n % 800};
    Vec3i z;
    for (size_t m = 0; m < 3; ++m) {
      t[0][m] = far(random);
      t[1][m] = far(random);
      t[2][m] = t[1][m] + near(random);
      point[m] = t[0][m] + x * (t[1][m] - t[0][m]) + y * (t[2][m] - t[0][m]);
      z[m] = static_cast<int32_t>(std::nearbyint((point[m] + (2 * any(random) - 1) * margin[m]) / kLatticeUnit));
    }
    bool within = true;
    for (size_t m = 0; m < 3; ++m) within &= std::abs(point[m] - z[m] * double{kLatticeUnit}) <= margin[m];
    const Vec3i around{20, 20, 20};
    int visits = 0;
    const auto visit = [&](int32_t i, int32_t j, int32_t first, int32_t end) {
      visits += i == z[0] && j == z[1] && first <= z[2] && z[2] < end ? 1 : 0;
    };
    ForEachRowNear(t, margin, VoxelsNear(t, margin, {z - around, z + around}), visit);
    EXPECT_LE(visits, 1);
    if (within) {
      EXPECT_EQ(visits, 1) << n;
    }
  }
  const Vec3i margin{128, 128, 128};
  const Triangle needle{{{0, 0, 0}, {51200, 51200, 51200}, {51200, 51200, 51201}}};
  int voxels = 0;
  ForEachRowNear(needle, margin, VoxelsNear(needle, margin, kEverywhere),
                 [&](int32_t, int32_t, int32_t first, int32_t end) { voxels += end - first; });
  EXPECT_GE(voxels, 201);
  EXPECT_LE(voxels, 8 * 201);
  const auto none = [](int32_t, int32_t, int32_t, int32_t) { FAIL(); };
  ForEachRowNear(needle, margin, VoxelsNear(needle, margin, {{300, 0, 0}, {400, 10, 10}}), none);
}

}  // namespace
}  // namespace latvox
