#include "client/tool/texture/texture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "client/mesh/srgb.h"
#include "client/tool/texture/decode_image.h"

namespace latvox::client {
namespace {

constexpr Wrap kWraps[] = {Wrap::kRepeat, Wrap::kMirror, Wrap::kClamp};

Pixels Noise(uint32_t width, uint32_t height) {
  std::mt19937 random(width * 1000 + height);
  Pixels pixels{width, height, std::vector<uint8_t>(size_t{4} * width * height)};
  for (uint8_t& byte : pixels.rgba) byte = static_cast<uint8_t>(random());
  return pixels;
}

int64_t Wrapped(int64_t n, int64_t count, Wrap wrap) {
  if (wrap == Wrap::kClamp) return std::clamp<int64_t>(n, 0, count - 1);
  const int64_t period = wrap == Wrap::kMirror ? 2 * count : count, within = (n % period + period) % period;
  return within < count ? within : period - 1 - within;
}

// The color of the plane at a point, in units of the image.
std::array<double, 4> At(const Pixels& pixels, double u, double v, const std::array<Wrap, 2>& wraps) {
  const auto x = Wrapped(static_cast<int64_t>(std::floor(u * pixels.width)), pixels.width, wraps[0]);
  const auto y = Wrapped(static_cast<int64_t>(std::floor(v * pixels.height)), pixels.height, wraps[1]);
  const uint8_t* const rgba = &pixels.rgba[static_cast<size_t>(4 * (y * pixels.width + x))];
  return {ToLinear(rgba[0]), ToLinear(rgba[1]), ToLinear(rgba[2]), rgba[3] / 255.0};
}

// The mean of many points of a rectangle.
std::array<double, 4> Sampled(const Pixels& pixels, Interval u, Interval v, const std::array<Wrap, 2>& wraps) {
  constexpr int kSide = 200;
  std::array<double, 4> mean{};
  for (int a = 0; a < kSide; ++a) {
    for (int b = 0; b < kSide; ++b) {
      const auto color = At(pixels, u.center + u.length * ((a + 0.5) / kSide - 0.5),
                            v.center + v.length * ((b + 0.5) / kSide - 0.5), wraps);
      for (size_t n = 0; n < 4; ++n) mean[n] += color[n] / (kSide * kSide);
    }
  }
  return mean;
}

double Distance(const LinearRgba& a, const std::array<double, 4>& b) {
  double most = 0;
  for (size_t n = 0; n < 4; ++n) most = std::max(most, std::abs(static_cast<double>(a[n]) - b[n]));
  return most;
}

TEST(Texture, MeansAreThoseOfManyPoints) {
  const Pixels pixels = Noise(7, 5);
  Texture texture(pixels);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-3, 3), length(0.02, 1);
  for (const Wrap along_u : kWraps) {
    for (const Wrap along_v : kWraps) {
      for (int n = 0; n < 4; ++n) {
        const Interval u{place(random), length(random)}, v{place(random), length(random)};
        const auto mean = texture.Mean(u, v, {along_u, along_v}, /*is_smooth=*/false);
        EXPECT_LT(Distance(mean, Sampled(pixels, u, v, {along_u, along_v})), 0.015)
            << u.center << " " << u.length << " " << v.center << " " << v.length;
      }
    }
  }
}

TEST(Texture, MeansOfManyPixelsAreThoseOfSmallerImages) {
  const Pixels pixels = Noise(301, 257);
  Texture texture(pixels);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> place(-2, 2), length(0.1, 0.5);
  for (const Wrap wrap : kWraps) {
    for (int n = 0; n < 4; ++n) {
      Interval u{place(random), length(random)}, v{place(random), length(random)};
      if (wrap == Wrap::kClamp) u.center = std::clamp(u.center, 0.25, 0.75);
      if (wrap == Wrap::kClamp) v.center = n == 0 ? 40 : std::clamp(v.center, 0.25, 0.75);  // 40: the last row
      const auto mean = texture.Mean(u, v, {wrap, wrap}, /*is_smooth=*/true);
      EXPECT_LT(Distance(mean, Sampled(pixels, u, v, {wrap, wrap})), 0.03);
    }
  }
}

TEST(Texture, TheWholeImageHasOneMeanWhereverItBegins) {
  const Pixels pixels = Noise(100, 33);
  Texture texture(pixels);
  std::array<double, 4> mean{};
  for (uint32_t y = 0; y < 33; ++y) {
    for (uint32_t x = 0; x < 100; ++x) {
      const auto color = At(pixels, (x + 0.5) / 100, (y + 0.5) / 33, {});
      for (size_t n = 0; n < 4; ++n) mean[n] += color[n] / 3300;
    }
  }
  for (const double begin : {0.0, 0.3, -17.25, 1e7}) {
    for (const double periods : {1.0, 2.0, 1000.0}) {
      const Interval whole{begin, periods};
      EXPECT_LT(Distance(texture.Mean(whole, whole, {}, true), mean), 1e-5) << begin;
    }
  }
  constexpr std::array<Wrap, 2> kMirrors{Wrap::kMirror, Wrap::kMirror};
  EXPECT_LT(Distance(texture.Mean({0.7, 2}, {-0.1, 1e9}, kMirrors, true), mean), 1e-5);
}

TEST(Texture, OnePixelIsInterpolatedOrNot) {
  Texture texture(Pixels{2, 1, {0, 0, 0, 0, 255, 255, 255, 255}});
  constexpr std::array<Wrap, 2> kClamps{Wrap::kClamp, Wrap::kClamp};
  for (const double u : {-5.0, 0.1, 0.25, 0.4, 0.5, 0.74, 0.75, 3.0}) {
    const double share = std::clamp(2 * u - 0.5, 0.0, 1.0);
    EXPECT_NEAR(texture.Mean({u, 0}, {0.5, 0}, kClamps, true)[3], share, 1e-6) << u;
    EXPECT_EQ(texture.Mean({u, 0}, {0.5, 0}, kClamps, false)[3], u < 0.5 ? 0 : 1) << u;
  }
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();
  for (const double bad : {kNaN, kInfinity, -kInfinity, 1e300}) {
    for (const Wrap wrap : kWraps) {
      const auto color = texture.Mean({bad, 0}, {bad, 0.5}, {wrap, wrap}, false);
      EXPECT_TRUE(color[3] >= 0 && color[3] <= 1) << bad;
    }
  }
}

TEST(DecodeImage, RefusesMorePixelsThanTheLimitBeforeItTakesMemory) {
  const std::string webp("RIFF\x1a\0\0\0WEBPVP8L\x0d\0\0\0\x2f\xff\xff\xff\x0f\0\0\0\0\0\0\0\0\0", 34);
  const auto limited = DecodeImage(webp, 1000);
  EXPECT_EQ(limited.status().code(), absl::StatusCode::kResourceExhausted) << limited.status();
  EXPECT_EQ(limited.status().message(), "has 16384 x 16384 pixels, and all images may together have 1000 more");
}

}  // namespace
}  // namespace latvox::client
