// The messages that bricks are filled into.
#include "server/wire/brick_batch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace latvox {
namespace {

TileBricks Tile(int32_t i, size_t bricks, double progress) {
  TileBricks tile;
  tile.tile_ijk = {i, 0, 0};
  for (size_t n = 0; n < bricks; ++n) {
    Brick brick{{8 * i, -1, static_cast<int32_t>(n)}, {}};
    brick.mask[n % 8] = 0x0123456789abcdef + n;
    tile.bricks.push_back(brick);
  }
  tile.progress = progress;
  return tile;
}

TEST(BrickBatcher, WritesCoordinatesAndMasksInTheContractsForm) {
  BrickBatcher batcher(BrickEncoding::kMasks);
  EXPECT_TRUE(batcher.empty());
  batcher.Add(Tile(-2, 3, 0.5));
  EXPECT_FALSE(batcher.empty());
  const v1::BrickBatch batch = batcher.Release();
  EXPECT_TRUE(batcher.empty());
  EXPECT_THAT(batch.brick_ijk(), ::testing::ElementsAre(-16, -1, 0, -16, -1, 1, -16, -1, 2));
  ASSERT_EQ(batch.masks().size(), 3 * 64);
  const std::string second = batch.masks().substr(64 + 8, 8);
  EXPECT_EQ(second, std::string("\xf0\xcd\xab\x89\x67\x45\x23\x01", 8));
  EXPECT_EQ(batch.progress(), 0.5);
}

TEST(BrickBatcher, FillsMessagesOfAQuarterToOneMebibyteAfterThreeSmallOnes) {
  BrickBatcher batcher(BrickEncoding::kMasks);
  int batches = 0;
  for (int n = 0; n < 200; ++n) {
    batcher.Add(Tile(n, 512, n / 200.0));
    if (!batcher.full()) continue;
    const size_t bytes = batcher.Release().ByteSizeLong();
    EXPECT_GE(bytes, batches < 3 ? (64 << 10) << batches : 256 << 10);
    EXPECT_LE(bytes, batches < 3 ? (128 << 10) << batches : 1 << 20);
    ++batches;
  }
  EXPECT_GT(batches, 5);
}

TEST(BrickBatcher, NeverTakesProgressBack) {
  BrickBatcher batcher(BrickEncoding::kMasks);
  double last = 0;
  for (const double progress : {0.3, 0.2, 0.9, 0.1, 1.5, 0.4}) {
    batcher.Add(Tile(0, 1, progress));
    const double told = batcher.Release().progress();
    EXPECT_GE(told, last);
    EXPECT_LE(told, 1);
    last = told;
  }
}

}  // namespace
}  // namespace latvox
