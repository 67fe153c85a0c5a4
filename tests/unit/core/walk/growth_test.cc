// Growth by a ball equals distances, point by point, also for the widest balls.
#include "core/walk/growth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "core/lattice/lattice.h"
#include "core/snap/snap.h"
#include "tests/unit/core/exact.h"

namespace latvox {
namespace {

// Members of a set, by tiles.
using Tiles = std::map<Vec3i, TileRows>;

Tiles TilesOf(const std::vector<Vec3i>& points) {
  Tiles tiles;
  for (const Vec3i& point : points) {
    const Vec3i tile = Shifted(point, kTileBits), at = point - tile * kTileSide;
    tiles[tile][static_cast<size_t>(at[0] << kTileBits | at[1])] |= uint64_t{1} << at[2];
  }
  return tiles;
}

bool IsWithin(const BandPlan& plan, const Vec3i& vector) {
  return Inner(plan.metric, vector * kLatticeUnit, vector * kLatticeUnit) <= plan.limit;
}

class BallOnLattice : public testing::TestWithParam<ExactLattice> {};

INSTANTIATE_TEST_SUITE_P(Exact, BallOnLattice, testing::ValuesIn(ExactLattices()),
                         [](const auto& lattice) { return lattice.param.name; });

// The length at which a vector reaches one voxel along its farthest axis.
double LengthOfAVoxel(const Lattice& lattice) {
  double most = 0;
  for (size_t m = 0; m < 3; ++m) {
    double square = 0;
    for (size_t c = 0; c < 3; ++c) square += lattice.inverse()[c][m] * lattice.inverse()[c][m];
    most = std::max(most, std::sqrt(square));
  }
  return 1 / most;
}

// Points in the tile, around it, and as far from it as the ball reaches along an axis.
std::vector<Vec3i> MembersAround(const Vec3i& reach, std::mt19937& random) {
  std::vector<Vec3i> members;
  std::uniform_int_distribution<int32_t> place(0, kTileSide - 1), far(-1, 1);
  for (int n = 0; n < 6; ++n) {
    Vec3i member;
    for (size_t m = 0; m < 3; ++m) member[m] = place(random) + far(random) * reach[m] * (n / 2);
    members.push_back(member);
  }
  for (size_t m = 0; m < 3; ++m) {
    for (const int32_t beyond : {-1, 0}) {
      Vec3i member{20, 30, 40};
      member[m] = kTileSide - 1 + reach[m] + beyond;
      members.push_back(member);
      member[m] = -reach[m] - beyond;
      members.push_back(member);
    }
  }
  return members;
}

// The reaches 1, 64, 65, 193, 256, and 257, which has the room for rounding. Some rows are looked at; the others are
// full already.
TEST_P(BallOnLattice, ReachesThePointsWithinItsLength) {
  const Lattice& lattice = GetParam().lattice;
  std::mt19937 random(5);
  std::uniform_int_distribution<size_t> any_row(0, kTileSide * kTileSide - 1);
  size_t reached = 0;
  for (const double voxels : {0.9, 63.9, 64.0, 192.9, 255.9, 256.0}) {
    SCOPED_TRACE(voxels);
    const BandPlan plan = MakeBandPlan({voxels * LengthOfAVoxel(lattice) * (1 - 0x1p-50), false}, lattice).value();
    ASSERT_EQ(*std::ranges::max_element(plan.reach), static_cast<int32_t>(std::floor(voxels)) + 1);
    const std::vector<Vec3i> members = MembersAround(plan.reach, random);
    const Tiles tiles = TilesOf(members);
    TileRows rows;
    rows.fill(~uint64_t{0});
    std::set<size_t> looked_at{0, 63, 20 << kTileBits | 30, 63 << kTileBits, 63 << kTileBits | 63};
    while (looked_at.size() < 20) looked_at.insert(any_row(random));
    for (const size_t row : looked_at) rows[row] = 0;
    const auto in_tile = [&](const Vec3i& beside) {
      const auto found = tiles.find(beside);
      return found == tiles.end() ? nullptr : &found->second;
    };
    Ball(plan).Grow(in_tile, {}, rows);
    for (const size_t row : looked_at) {
      const auto i = static_cast<int32_t>(row >> kTileBits), j = static_cast<int32_t>(row & (kTileSide - 1));
      uint64_t expected = 0;
      for (int32_t k = 0; k < kTileSide; ++k) {
        const auto is_near = [&](const Vec3i& member) { return IsWithin(plan, Vec3i{i, j, k} - member); };
        if (std::ranges::any_of(members, is_near)) expected |= uint64_t{1} << k;
      }
      ASSERT_EQ(rows[row], expected) << i << ' ' << j;
      reached += static_cast<size_t>(std::popcount(expected));
    }
  }
  EXPECT_GT(reached, 500U);
}

}  // namespace
}  // namespace latvox
