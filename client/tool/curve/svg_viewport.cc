#include "client/tool/curve/svg_viewport.h"

#include <algorithm>
#include <vector>

#include "absl/strings/match.h"

namespace latvox::client {
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
