// Bricks that a box cuts, compared with a test of every voxel.
#include "core/brick/brick.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <random>

namespace latvox {
namespace {

constexpr int32_t kLeast = std::numeric_limits<int32_t>::min(), kMost = std::numeric_limits<int32_t>::max();

BrickMask ClippedOneByOne(const IndexBox& box, const Brick& brick) {
  BrickMask mask{};
  for (int32_t n = 0; n < 512; ++n) {
    const Vec3i ijk = brick.brick_ijk * kBrickSide + Vec3i{n >> 6, n >> 3 & 7, n & 7};
    const auto word = static_cast<size_t>(n >> 6);
    if (box.Contains(ijk)) mask[word] |= brick.mask[word] & uint64_t{1} << (n & 63);
  }
  return mask;
}

void ExpectClipped(const IndexBox& box, Brick brick) {
  const BrickMask expected = ClippedOneByOne(box, brick);
  ClipBrick(box, brick);
  EXPECT_EQ(brick.mask, expected) << box.min[0] << ' ' << box.min[1] << ' ' << box.min[2] << ' ' << box.max[0] << ' '
                                  << box.max[1] << ' ' << box.max[2];
}

TEST(Brick, KeepsTheVoxelsOfABox) {
  std::mt19937_64 random(1);
  std::uniform_int_distribution<int32_t> any(-20, 20);
  for (int n = 0; n < 20'000; ++n) {
    Brick brick{{any(random) / 8, any(random) / 8, any(random) / 8}, {}};
    for (uint64_t& word : brick.mask) word = random();
    IndexBox box;
    for (size_t m = 0; m < 3; ++m) box.min[m] = any(random), box.max[m] = any(random);  // some boxes are empty
    ExpectClipped(box, brick);
  }
}

TEST(Brick, KeepsTheVoxelsOfTheLargestBox) {
  BrickMask full;
  full.fill(~uint64_t{0});
  const IndexBox all{{kLeast, kLeast, kLeast}, {kMost, kMost, kMost}};
  for (const int32_t n : {kLeast / kBrickSide, -1, 0, kMost / kBrickSide}) ExpectClipped(all, {{n, n, n}, full});
  ExpectClipped({{0, kLeast, kMost}, {kMost, 3, kMost}}, {{0, 0, 0}, full});
}

}  // namespace
}  // namespace latvox
