// The index of many walks' cubes, beside a list of them.
#include "core/walk/joint_cubes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <vector>

namespace latvox {
namespace {

constexpr int kLevel = 4;
constexpr Vec3i kFirst{-3, 0, 7};

struct Cube {
  uint32_t rank;
  Vec3i tile_ijk;
  int level;
};

bool Contains(const Cube& cube, const Vec3i& tile_ijk, int level) {
  for (size_t m = 0; m < 3; ++m) {
    const int32_t low = cube.tile_ijk[m], at = tile_ijk[m];
    if (at < low || at + (1 << level) > low + (1 << cube.level)) return false;
  }
  return true;
}

// Cubes of several levels that do not overlap within a rank, as a walk has them.
std::vector<Cube> RandomCubes(uint32_t ranks, std::mt19937& random) {
  std::vector<Cube> cubes;
  for (uint32_t rank = 0; rank < ranks; ++rank) {
    std::vector<Cube> of_rank;
    for (size_t n = 0; n < rank % 7; ++n) {
      const int level = static_cast<int>(random() % kLevel);
      Cube cube{rank, {}, level};
      for (size_t m = 0; m < 3; ++m) {
        cube.tile_ijk[m] = kFirst[m] + static_cast<int32_t>(random() % (1U << (kLevel - level))) * (1 << level);
      }
      const bool overlaps = std::ranges::any_of(of_rank, [&](const Cube& other) {
        return Contains(other, cube.tile_ijk, cube.level) || Contains(cube, other.tile_ijk, other.level);
      });
      if (!overlaps) of_rank.push_back(cube);
    }
    cubes.insert(cubes.end(), of_rank.begin(), of_rank.end());
  }
  return cubes;
}

TEST(JointCubes, EqualAListOfCubes) {
  std::mt19937 random(5);
  size_t held = 0, free = 0;
  for (const uint32_t ranks : {0U, 2U, 3U, 10U, 40U}) {
    const std::vector<Cube> cubes = RandomCubes(ranks, random);
    JointCubes joint(kFirst, kLevel);
    for (const Cube& cube : cubes) joint.Add(cube.rank, cube.tile_ijk, cube.level);
    for (int level = 0; level <= kLevel; ++level) {
      for (int32_t n = 0; n < 1 << 3 * (kLevel - level); ++n) {
        const int32_t side = kLevel - level, mask = (1 << side) - 1;
        const Vec3i at = kFirst + Vec3i{n >> 2 * side & mask, n >> side & mask, n & mask} * (1 << level);
        std::set<uint32_t> expected;
        for (const Cube& cube : cubes) {
          // A single tile counts as the cube of 2^3 tiles with it.
          Cube of_index = cube;
          of_index.level = std::max(cube.level, JointCubes::kLeastLevel);
          of_index.tile_ijk = kFirst + Shifted(cube.tile_ijk - kFirst, of_index.level) * (1 << of_index.level);
          if (Contains(of_index, at, level) || Contains({0, at, level}, cube.tile_ijk, cube.level)) {
            expected.insert(cube.rank);
          }
        }
        ++(expected.empty() ? free : held);
        if (level >= JointCubes::kLeastLevel) {
          ASSERT_EQ(joint.MayHold(at, level), !expected.empty());
          continue;
        }
        std::vector<uint32_t> ranks_at;
        EXPECT_FALSE(joint.AnyAt(at, [&](uint32_t rank) {
          ranks_at.push_back(rank);
          return false;
        }));
        std::ranges::sort(ranks_at);
        ASSERT_EQ(ranks_at, std::vector<uint32_t>(expected.begin(), expected.end()));
        EXPECT_EQ(joint.AnyAt(at, [](uint32_t) { return true; }), !expected.empty());
      }
    }
  }
  EXPECT_GT(held, 1000U);
  EXPECT_GT(free, 1000U);
}

TEST(JointCubes, MayBeOneTile) {
  JointCubes joint(kFirst, 0);
  const auto any = [](uint32_t) { return true; };
  EXPECT_FALSE(joint.AnyAt(kFirst, any));
  joint.Add(3, kFirst, 0);
  EXPECT_TRUE(joint.AnyAt(kFirst, any));
}

}  // namespace
}  // namespace latvox
