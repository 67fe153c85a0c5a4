#include "client/tool/output/picture_style.h"

#include <gmock/gmock.h>
#include <png.h>

#include "client/tool/output/lettering.h"
#include "tests/unit/client/fields.h"

namespace latvox::client {
namespace {

using testing::ElementsAre;

// Reads a PNG file. `channels` receives 3 or 4.
Image Decode(const std::string& png, int* channels = nullptr) {
  png_image read{};
  read.version = PNG_IMAGE_VERSION;
  EXPECT_TRUE(png_image_begin_read_from_memory(&read, png.data(), png.size()));
  if (channels != nullptr) *channels = (read.format & PNG_FORMAT_FLAG_ALPHA) != 0 ? 4 : 3;
  read.format = PNG_FORMAT_RGBA;
  Image image(static_cast<int>(read.width), static_cast<int>(read.height));
  EXPECT_TRUE(png_image_finish_read(&read, nullptr, image.At(0, 0), 0, nullptr));
  return image;
}

std::array<int, 4> Pixel(const Image& image, int x, int y) {
  const uint8_t* const p = image.At(x, y);
  return {p[0], p[1], p[2], p[3]};
}

// A red pixel that is opaque, one that is half so, and nothing.
Image MakePicture() {
  Image picture(64, 32);
  picture.PaintOver(0, 0, {255, 0, 0}, 1);
  picture.PaintOver(1, 0, {255, 0, 0}, 0.5);
  return picture;
}

TEST(PictureStyle, ABackgroundIsBehindThePicture) {
  int channels = 0;
  const Image blue = Decode(*FinishPicture(MakePicture(), 1, {.background = Rgb8{0, 0, 255}}), &channels);
  EXPECT_EQ(channels, 3);
  EXPECT_THAT(Pixel(blue, 0, 0), ElementsAre(255, 0, 0, 255));
  EXPECT_THAT(Pixel(blue, 1, 0), ElementsAre(186, 0, 186, 255))
      << "half of each light, which is not half of each level";
  EXPECT_THAT(Pixel(blue, 2, 0), ElementsAre(0, 0, 255, 255));
  const Image clear = Decode(*FinishPicture(MakePicture(), 1, {.background = std::nullopt}), &channels);
  EXPECT_EQ(channels, 4);
  EXPECT_THAT(Pixel(clear, 0, 0), ElementsAre(255, 0, 0, 255));
  EXPECT_THAT(Pixel(clear, 1, 0), ElementsAre(255, 0, 0, 128));
  EXPECT_EQ(Pixel(clear, 2, 0)[3], 0);
}

TEST(PictureStyle, ALegendIsBelowThePicture) {
  Legend legend;
  for (const uint32_t color : {0x00FF00u, 0x0000FFu}) legend.entries.push_back({color, "part 0: 12 voxels"});
  const Image with = Decode(*FinishPicture(Image(400, 50), 100, {.background = Rgb8{255, 255, 255}, .legend = legend}));
  EXPECT_GT(with.height(), 60);
  int green = 0, blue = 0, dark = 0, above = 0;
  for (int y = 0; y < with.height(); ++y) {
    for (int x = 0; x < with.width(); ++x) {
      const auto [r, g, b, a] = Pixel(with, x, y);
      green += r == 0 && g == 255;
      blue += r == 0 && b == 255;
      dark += r < 60 && g < 60 && b < 60;
      above += y < 50 && (r < 255 || g < 255);
    }
  }
  EXPECT_GE(green, 64) << "a square as high as digits, which are 9 pixels";
  EXPECT_EQ(green, blue);
  EXPECT_GT(dark, 200);
  EXPECT_EQ(above, 0);
  // More entries than fit into a row take another row.
  legend.entries.resize(12, legend.entries[0]);
  EXPECT_GT(Decode(*FinishPicture(Image(400, 50), 100, {.legend = legend})).height(), with.height() + 50);
}

TEST(PictureStyle, AScaleBarIsARoundNumberOfTheWorldsUnits) {
  for (const auto& [most, length] :
       {std::pair{0.9, 0.5}, {1.0, 1.0}, {19.9, 10.0}, {20.0, 20.0}, {5e-7, 5e-7}, {4e12, 2e12}}) {
    EXPECT_NEAR(BarLength(most) / length, 1, 1e-9) << most;
  }
  // 100 pixels are 1; the bar is at most a quarter of 400.
  const Image bar = Decode(*FinishPicture(Image(400, 1), 100, {.background = Rgb8{255, 255, 255}, .legend = Legend()}));
  int longest = 0;
  for (int y = 1; y < bar.height(); ++y) {
    for (int x = 0, run = 0; x < bar.width(); ++x)
      longest = std::max(longest, run = bar.At(x, y)[0] < 60 ? run + 1 : 0);
  }
  EXPECT_NEAR(longest, 100, 1);
}

TEST(PictureStyle, AnyTextCanBeLettered) {
  EXPECT_EQ(LetteringWidth("\u00fc", 12), LetteringWidth("?", 12)) << "boxes";
  EXPECT_EQ(LetteringWidth("", 12), 0);
}

TEST(PictureStyle, LettersAreAsWideAsTheySay) {
  for (const char character :
       std::string("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.,:-+#_()/?")) {
    const std::string text(1, character);
    Image image(60, 60);
    Letter(text, 10, 40, 24, {1, 2, 3}, image);
    int left = 60, right = 0, top = 60, bottom = 0;
    for (int n = 0; n < 3600; ++n) {
      if (image.At(n % 60, n / 60)[3] == 0) continue;
      left = std::min(left, n % 60), right = std::max(right, n % 60 + 1);
      top = std::min(top, n / 60), bottom = std::max(bottom, n / 60 + 1);
    }
    EXPECT_GE(left, 6) << text;
    EXPECT_LE(right, 10 + LetteringWidth(text, 24) - 4) << text << " keeps its distance from the next one";
    EXPECT_TRUE(top >= 13 && bottom <= 51 && bottom > top) << text;
    if (character >= '0' && character <= '9') {
      EXPECT_NEAR(bottom - top, 24 + 4, 1.5) << text << ", and its line";
    }
  }
}

TEST(Legend, CountsVoxels) {
  GridContent content;
  content.fields = {ValuesOf<uint32_t>(Field::kPart, {3, 1, 3, 3}),
                    ValuesOf<uint8_t>(Field::kColor, {255, 0, 0, 0, 255, 0, 0, 255, 0, 0, 255, 0})};
  const auto texts = [&](ColorBy by, size_t most) {
    std::vector<std::string> found;
    for (const LegendEntry& entry : LegendOf(content, by, most).entries) found.push_back(entry.text);
    return found;
  };
  EXPECT_THAT(texts(ColorBy::kPart, 9), ElementsAre("part 1: 1 voxel", "part 3: 3 voxels"));
  EXPECT_THAT(texts(ColorBy::kColor, 9), ElementsAre("#00ff00: 3 voxels", "#ff0000: 1 voxel"));
  EXPECT_THAT(texts(ColorBy::kColor, 1), ElementsAre("#00ff00: 3 voxels", "and 1 more"));
  EXPECT_THAT(texts(ColorBy::kNone, 9), ElementsAre());
  EXPECT_THAT(texts(ColorBy::kNormal, 9), ElementsAre("x", "y", "z", "-x", "-y", "-z"));
  EXPECT_THAT(texts(ColorBy::kPoint, 9), ElementsAre("corner 1", "corner 2", "corner 3"));
}

TEST(Legend, OfFractionsOfLabelsSaysHowManyVoxelsTheyWouldFill) {
  GridContent content;
  content.file.info.metadata = {{"latvox_fraction_n", "2"}, {"latvox_part_names", R"(["", "lid"])"}};
  content.fields = {ValuesOf<uint16_t>(Field::kLabelFractions, {8, 0, 4, 2, 0, 8, 0, 1})};
  content.fields[0].labels = {7, 1};
  const auto texts = [&](size_t most) {
    std::vector<std::string> found;
    for (const LegendEntry& entry : LegendOf(content, ColorBy::kLabelFractions, most).entries) {
      found.push_back(entry.text);
    }
    return found;
  };
  EXPECT_THAT(texts(9), ElementsAre("label 7: 1.5 voxels", "label 1 (lid): 1.4 voxels", "elsewhere"));
  EXPECT_THAT(texts(1), ElementsAre("label 7: 1.5 voxels", "and 1 more", "elsewhere"));
}

TEST(Legend, OfABandIsARamp) {
  const DistanceRange range{.most = 0.25, .is_signed = true};
  GridContent content;
  content.distances = range;
  const Legend legend = LegendOf(content, ColorBy::kDistance, 9);
  EXPECT_TRUE(legend.is_ramp);
  EXPECT_EQ(legend.entries.front().text, "-0.25");
  EXPECT_EQ(legend.entries.back().text, "0.25");
  EXPECT_EQ(legend.entries.front().color, DistanceColor(-0.25F, range));
}

}  // namespace
}  // namespace latvox::client
