#include "client/tool/texture/texture.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "client/mesh/srgb.h"

namespace latvox::client {
namespace {

// A texel along one axis, and its share of an interval.
struct Share {
  uint32_t texel;
  double weight;
};
using Shares = std::vector<Share>;

const std::array<float, 256>& LinearOfBytes() {
  static const auto* const kTable = [] {
    auto* const table = new std::array<float, 256>;
    for (size_t n = 0; n < table->size(); ++n) (*table)[n] = static_cast<float>(ToLinear(static_cast<uint8_t>(n)));
    return table;
  }();
  return *kTable;
}

// Adds the shares of the texels from `low` to `high`, in texels. Texel n is `texel_of(n)`.
template <class TexelOf>
void AddShares(double low, double high, const TexelOf& texel_of, Shares& shares) {
  for (double n = std::floor(low); n < high; ++n) {
    const double weight = std::min(high, n + 1) - std::max(low, n);
    if (weight > 0) shares.push_back({texel_of(static_cast<int64_t>(n)), weight});
  }
}

// Beyond an edge, its texel goes on.
void AddClamped(double low, double high, uint32_t count, Shares& shares) {
  const double end = count;
  if (low < 0) shares.push_back({0, std::min(high, 0.0) - low});
  AddShares(
      std::clamp(low, 0.0, end), std::clamp(high, 0.0, end), [](int64_t n) { return static_cast<uint32_t>(n); },
      shares);
  if (high > end) shares.push_back({count - 1, high - std::max(low, end)});
}

// Returns the shares of an interval along an axis of `count` texels; of the texel at its center if it has no length.
Shares SharesOf(Interval interval, uint32_t count, Wrap wrap) {
  constexpr double kFar = 1 << 30;  // periods; beyond, floats have no fractions
  const double size = count, period = wrap == Wrap::kMirror ? 2 * size : size;
  double center = interval.center * size, length = interval.length * size;
  if (!(std::abs(center) < kFar * size)) center = 0;
  if (wrap != Wrap::kClamp) {
    center -= period * std::floor(center / period);
    length = std::min(length, period);
  }
  const auto texel_of = [=](int64_t n) {
    const auto whole = static_cast<int64_t>(period);
    const int64_t within = (n % whole + whole) % whole;
    return static_cast<uint32_t>(within < count ? within : whole - 1 - within);
  };
  Shares shares;
  const double low = center - length / 2, high = center + length / 2;
  if (!(high > low)) {
    const double texel = std::floor(center);
    const uint32_t clamped = static_cast<uint32_t>(std::clamp(texel, 0.0, size - 1));
    shares.push_back({wrap == Wrap::kClamp ? clamped : texel_of(static_cast<int64_t>(texel)), 1});
  } else if (wrap == Wrap::kClamp) {
    AddClamped(low, high, count, shares);
  } else {
    AddShares(low, high, texel_of, shares);
  }
  return shares;
}

// Returns the mean of `at(x, y)` with the weights of the shares.
template <class At>
LinearRgba MeanOf(const Shares& along_x, const Shares& along_y, const At& at) {
  std::array<double, 4> sum{};
  double weights = 0;
  for (const auto& [y, weight_y] : along_y) {
    for (const auto& [x, weight_x] : along_x) {
      const LinearRgba& texel = at(x, y);
      const double weight = weight_x * weight_y;
      for (size_t n = 0; n < sum.size(); ++n) sum[n] += weight * static_cast<double>(texel[n]);
      weights += weight;
    }
  }
  LinearRgba mean;
  for (size_t n = 0; n < sum.size(); ++n) mean[n] = static_cast<float>(sum[n] / weights);
  return mean;
}

// Returns the texels that an interval covers along an axis of `count`, without those before the first and after the
// last where the outermost ones go on.
double CoveredTexels(Interval interval, uint32_t count, Wrap wrap) {
  const auto [center, length] = interval;
  if (wrap != Wrap::kClamp) return std::min(length, wrap == Wrap::kMirror ? 2.0 : 1.0) * count;
  const double inside = std::min(center + length / 2, 1.0) - std::max(center - length / 2, 0.0);
  return std::max(inside * count, 1.0);
}

}  // namespace

Texture::Texture(Pixels pixels) : pixels_(std::move(pixels)) {}

LinearRgba Texture::Mean(Interval u, Interval v, const std::array<Wrap, 2>& wraps, bool is_smooth) {
  if (is_smooth) {
    u.length = std::max(u.length, 1.0 / pixels_.width);
    v.length = std::max(v.length, 1.0 / pixels_.height);
  }
  size_t level = 0;
  while (CoveredTexels(u, WidthOf(level), wraps[0]) * CoveredTexels(v, HeightOf(level), wraps[1]) > kMostTexels &&
         (WidthOf(level) > 1 || HeightOf(level) > 1)) {
    if (level == levels_.size()) AddLevel();
    ++level;
  }
  return MeanOf(SharesOf(u, WidthOf(level), wraps[0]), SharesOf(v, HeightOf(level), wraps[1]),
                [&](uint32_t x, uint32_t y) -> const LinearRgba& { return At(level, x, y); });
}

const LinearRgba& Texture::At(size_t level, uint32_t x, uint32_t y) {
  if (level > 0) return levels_[level - 1].texels[size_t{y} * levels_[level - 1].width + x];
  const auto& linear = LinearOfBytes();
  const uint8_t* const rgba = &pixels_.rgba[4 * (size_t{y} * pixels_.width + x)];
  pixel_ = {linear[rgba[0]], linear[rgba[1]], linear[rgba[2]], static_cast<float>(rgba[3]) / 255};
  return pixel_;
}

// Halves both sides, rounded down; a texel is the mean of all that it covers, which may be parts of texels.
void Texture::AddLevel() {
  const size_t from = levels_.size();
  Level level{std::max(WidthOf(from) / 2, 1U), std::max(HeightOf(from) / 2, 1U)};
  const auto shares = [](uint32_t n, uint32_t count, uint32_t of) {
    return SharesOf({(n + 0.5) / count, 1.0 / count}, of, Wrap::kClamp);
  };
  std::vector<Shares> along_x;
  for (uint32_t x = 0; x < level.width; ++x) along_x.push_back(shares(x, level.width, WidthOf(from)));
  level.texels.reserve(size_t{level.width} * level.height);
  for (uint32_t y = 0; y < level.height; ++y) {
    const Shares along_y = shares(y, level.height, HeightOf(from));
    for (uint32_t x = 0; x < level.width; ++x) {
      level.texels.push_back(
          MeanOf(along_x[x], along_y, [&](uint32_t i, uint32_t j) -> const LinearRgba& { return At(from, i, j); }));
    }
  }
  levels_.push_back(std::move(level));
}

}  // namespace latvox::client
