#include "client/tool/curve/svg_transform.h"

#include <cmath>
#include <numbers>
#include <optional>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "client/tool/curve/scan.h"

namespace latvox::client {
namespace {

double Radians(double degrees) { return degrees * std::numbers::pi / 180; }

// std::cos is not 0 at the double nearest to a right angle.
Affine Rotation(double degrees) {
  const double quarters = std::remainder(degrees, 360) / 90;
  double cos = std::cos(Radians(degrees)), sin = std::sin(Radians(degrees));
  if (quarters == std::round(quarters)) {
    cos = std::round(cos);
    sin = std::round(sin);
  }
  return {cos, sin, -sin, cos, 0, 0};
}

// Returns nothing for an unknown name, or one that needs another number of numbers.
std::optional<Affine> TransformOf(absl::string_view name, const std::vector<double>& n) {
  const bool one_or_two = n.size() == 1 || n.size() == 2;
  if (name == "translate" && one_or_two) return Translation(n[0], n.size() == 2 ? n[1] : 0);
  if (name == "scale" && one_or_two) return Affine{n[0], 0, 0, n.back(), 0, 0};
  if (name == "rotate" && n.size() == 1) return Rotation(n[0]);
  if (name == "rotate" && n.size() == 3) {
    return Compose(Compose(Translation(n[1], n[2]), Rotation(n[0])), Translation(-n[1], -n[2]));
  }
  if (name == "skewX" && n.size() == 1) return Affine{1, 0, std::tan(Radians(n[0])), 1, 0, 0};
  if (name == "skewY" && n.size() == 1) return Affine{1, std::tan(Radians(n[0])), 0, 1, 0, 0};
  if (name == "matrix" && n.size() == 6) return Affine{n[0], n[1], n[2], n[3], n[4], n[5]};
  return std::nullopt;
}

}  // namespace

Affine Translation(double x, double y) { return {1, 0, 0, 1, x, y}; }

Affine Compose(const Affine& outer, const Affine& inner) {
  const auto linear = [&](double x, double y) { return Vec2d{outer.a * x + outer.c * y, outer.b * x + outer.d * y}; };
  const Vec2d i = linear(inner.a, inner.b), j = linear(inner.c, inner.d), o = outer({inner.e, inner.f});
  return {i[0], i[1], j[0], j[1], o[0], o[1]};
}

absl::StatusOr<Affine> ParseTransforms(absl::string_view text) {
  Affine transform;
  for (absl::string_view rest = text; SkipSeparator(rest), !rest.empty();) {
    const size_t open = rest.find('('), close = rest.find(')');
    std::vector<double> numbers;
    std::optional<Affine> one;
    if (open < close && close != absl::string_view::npos &&
        ParseNumbers(rest.substr(open + 1, close - open - 1), numbers)) {
      one = TransformOf(absl::StripAsciiWhitespace(rest.substr(0, open)), numbers);
    }
    if (!one) {
      return absl::InvalidArgumentError(
          absl::StrCat("transform \"", rest, "\" does not begin with translate(x,y), scale(x,y), rotate(angle,x,y), ",
                       "skewX(angle), skewY(angle) or matrix(6)"));
    }
    transform = Compose(transform, *one);
    rest.remove_prefix(close + 1);
  }
  return transform;
}

bool ParseNumbers(absl::string_view text, std::vector<double>& numbers) {
  SkipSpace(text);
  while (!text.empty()) {
    if (!ReadDecimal(text, numbers.emplace_back())) return false;
    SkipSeparator(text);
  }
  return true;
}

}  // namespace latvox::client
