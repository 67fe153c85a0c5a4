#include "client/tool/curve/svg_viewport.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "client/tool/curve/scan.h"

namespace latvox::client {
namespace {

// User units in one.
constexpr std::pair<absl::string_view, double> kUnits[] = {{"", 1},           {"px", 1},         {"in", 96},
                                                           {"cm", 96 / 2.54}, {"mm", 96 / 25.4}, {"q", 96 / 101.6},
                                                           {"pt", 96.0 / 72}, {"pc", 16}};

}  // namespace

absl::Status ReadLength(const pugi::xml_node& node, const char* name, Along along, const Viewport& viewport,
                        double& value) {
  const pugi::xml_attribute attribute = node.attribute(name);
  if (!attribute) return absl::OkStatus();
  absl::string_view text = absl::StripAsciiWhitespace(attribute.value());
  double number = 0;
  const auto refusal = [&](absl::string_view why) {
    return absl::InvalidArgumentError(absl::StrCat(name, " \"", attribute.value(), "\" ", why));
  };
  constexpr absl::string_view kWanted = "is not a finite number, also of px, in, cm, mm, Q, pt, pc or %";
  if (!ReadDecimal(text, number)) return refusal(kWanted);
  if (text == "%") {
    const auto& [width, height] = viewport;
    if ((along != Along::kY && !width) || (along != Along::kX && !height)) {
      return refusal("needs a viewBox, or width and height, of the drawing");
    }
    const double whole = along == Along::kX   ? *width
                         : along == Along::kY ? *height
                                              : std::hypot(*width, *height) / std::numbers::sqrt2;
    value = number / 100 * whole;
    return absl::OkStatus();
  }
  for (const auto& [unit, factor] : kUnits) {
    if (!absl::EqualsIgnoreCase(text, unit)) continue;
    value = number * factor;
    return absl::OkStatus();
  }
  return refusal(kWanted);
}

std::optional<ViewBox> ParseViewBox(absl::string_view text) {
  std::vector<double> n;
  if (!ParseNumbers(text, n) || n.size() != 4 || !(n[2] > 0) || !(n[3] > 0)) return std::nullopt;
  return ViewBox{{n[0], n[1]}, {n[2], n[3]}};
}

Affine FitViewBox(const ViewBox& view, const Vec2d& viewport, absl::string_view aspect) {
  const auto has = [aspect](absl::string_view word) { return absl::StrContains(aspect, word); };
  const auto share = [&](absl::string_view least, absl::string_view most) {
    return has(least) ? 0 : has(most) ? 1 : 0.5;
  };
  Vec2d scale = {viewport[0] / view.size[0], viewport[1] / view.size[1]};
  if (!has("none")) {
    scale[0] = scale[1] = has("slice") ? std::max(scale[0], scale[1]) : std::min(scale[0], scale[1]);
  }
  const Vec2d shares = {share("xMin", "xMax"), share("YMin", "YMax")};
  Affine fit{scale[0], 0, 0, scale[1], 0, 0};
  fit.e = shares[0] * (viewport[0] - scale[0] * view.size[0]) - scale[0] * view.low[0];
  fit.f = shares[1] * (viewport[1] - scale[1] * view.size[1]) - scale[1] * view.low[1];
  return fit;
}

}  // namespace latvox::client
