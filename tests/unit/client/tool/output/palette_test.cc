#include "client/tool/output/palette.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <random>

namespace latvox::client {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<uint32_t> RandomColors(size_t number) {
  std::mt19937 random(1);
  std::vector<uint32_t> colors(number);
  for (uint32_t& color : colors) color = random() & 0xFFFFFF;
  return colors;
}

TEST(Palette, HoldsFewColorsExactly) {
  const Palette palette = PaletteOf(std::vector<uint32_t>{0xFF0000, 0x0000FF, 0xFF0000, 0x00FF00}, 3);
  EXPECT_THAT(palette.colors, ElementsAre(0x0000FF, 0x00FF00, 0xFF0000));
  EXPECT_EQ(palette.number_of.at(0x00FF00), 1);
  EXPECT_THAT(PaletteOf({}, 255).colors, IsEmpty());
}

TEST(Palette, ReducesManyColorsToSimilarOnes) {
  const std::vector<uint32_t> colors = RandomColors(20000);
  const Palette palette = PaletteOf(colors, 255);
  EXPECT_EQ(palette.colors.size(), 255);
  double sum = 0;
  for (const uint32_t color : colors) {
    const uint32_t near = palette.colors[palette.number_of.at(color)];
    for (const int shift : {0, 8, 16}) {
      sum += std::abs(static_cast<int>(color >> shift & 0xFF) - static_cast<int>(near >> shift & 0xFF));
    }
  }
  // A cube of 6 colors a side is 43 wide, so that its mean difference is 11. One color for all gives 64.
  EXPECT_LT(sum / (3 * 20000), 13);
}

TEST(Palette, DoesNotDependOnTheOrderOfColors) {
  std::vector<uint32_t> colors = RandomColors(3000);
  const Palette palette = PaletteOf(colors, 16);
  std::ranges::reverse(colors);
  EXPECT_EQ(PaletteOf(colors, 16).colors, palette.colors);
  EXPECT_EQ(PaletteOf(colors, 16).number_of, palette.number_of);
}

TEST(Palette, KeepsTheMeanOfEachGroup) {
  const std::vector<uint32_t> colors = {0x000000, 0x000002, 0x000002, 0x000002, 0xFF0000, 0xFF0200};
  const Palette palette = PaletteOf(colors, 2);
  EXPECT_THAT(palette.colors, testing::UnorderedElementsAre(0x000002, 0xFF0100));
  EXPECT_EQ(palette.number_of.at(0x000000), palette.number_of.at(0x000002));
  EXPECT_THAT(PaletteOf(colors, 1).colors, ElementsAre(0x550001));
}

}  // namespace
}  // namespace latvox::client
