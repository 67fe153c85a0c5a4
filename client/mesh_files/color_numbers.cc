#include "client/mesh_files/color_numbers.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "client/mesh_files/bad.h"

namespace latvox::client {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kRounding = 0.01;  // by which programs exceed 0 and 1

bool IsMissing(const ColorNumbers::Numbers& color) { return std::isnan(color[0]); }

}  // namespace

void ColorNumbers::Add(const Numbers& rgb) {
  Numbers color = rgb;
  for (double& number : color) {
    if (std::isnan(number)) number = -std::numeric_limits<double>::infinity();  // on no scale
  }
  colors_.push_back(color);
}

void ColorNumbers::AddMissing() {
  if (missing_++ == 0) first_missing_ = colors_.size();
  colors_.push_back({kNone, kNone, kNone});
}

absl::StatusOr<std::vector<Color>> ColorNumbers::ToBytes(const std::string& element, size_t base) const {
  double most = 0;
  bool integers = true;
  for (const Numbers& color : colors_) {
    if (IsMissing(color)) continue;
    for (const double number : color) {
      most = std::max(most, number);
      integers = integers && number == std::floor(number);
    }
  }
  const double full = most > 2 || (most > 1 && integers) ? 255 : 1;
  std::vector<Color> bytes(colors_.size(), Color{255, 255, 255});
  for (size_t n = 0; n < colors_.size(); ++n) {
    if (IsMissing(colors_[n])) continue;
    for (size_t part = 0; part < 3; ++part) {
      const double share = colors_[n][part] / full;
      if (!(share >= -kRounding && share <= 1 + kRounding)) {
        return Bad("color ", colors_[n][part], " of ", element, " ", n + base, " is not within 0 and ", full);
      }
      bytes[n][part] = static_cast<uint8_t>(std::nearbyint(std::clamp(share, 0., 1.) * 255));
    }
  }
  return bytes;
}

}  // namespace latvox::client
