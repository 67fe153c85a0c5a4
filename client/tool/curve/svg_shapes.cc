#include "client/tool/curve/svg_shapes.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

#include "absl/strings/strip.h"
#include "client/tool/curve/svg_arc.h"
#include "client/tool/curve/svg_transform.h"

namespace latvox::client {
namespace {

absl::Status Bad(absl::string_view why) { return absl::InvalidArgumentError(why); }

class ShapeReader {
 public:
  ShapeReader(const pugi::xml_node& node, const Viewport& viewport, std::vector<Outline>& outlines)
      : node_(node), viewport_(viewport), outlines_(outlines) {}

  absl::Status Append(absl::string_view name) {
    if (name == "polyline") return ReadPoints(/*closed=*/false);
    if (name == "polygon") return ReadPoints(/*closed=*/true);
    if (name == "line") return ReadLine();
    if (name == "rect") return ReadRect();
    if (name == "circle" || name == "ellipse") return ReadEllipse(name == "circle");
    if (name == "text") return Bad("has no outlines; convert text to paths");
    if (name != "path") {
      return Bad("is not one of svg, g, a, switch, use, polyline, polygon, line, rect, circle, ellipse, path");
    }
    return ParsePathData(node_.attribute("d").value(), outlines_);
  }

 private:
  absl::Status ReadPoints(bool closed) {
    std::vector<double> numbers;
    if (!ParseNumbers(node_.attribute("points").value(), numbers) || numbers.size() % 2 != 0) {
      return Bad("points are not pairs of finite numbers");
    }
    std::vector<Vec2d> points;
    for (size_t n = 0; n < numbers.size(); n += 2) points.push_back({numbers[n], numbers[n + 1]});
    AddOutline(points, closed);
    return absl::OkStatus();
  }

  absl::Status ReadLine() {
    std::array<Vec2d, 2> ends{};
    constexpr const char* kNames[2][2] = {{"x1", "y1"}, {"x2", "y2"}};
    for (size_t n = 0; n < 2; ++n) {
      for (size_t m = 0; m < 2; ++m) {
        const Along along = m == 0 ? Along::kX : Along::kY;
        if (auto status = ReadLength(node_, kNames[n][m], along, viewport_, ends[n][m]); !status.ok()) return status;
      }
    }
    AddOutline({ends[0], ends[1]}, /*closed=*/false);
    return absl::OkStatus();
  }

  // Reads rx and ry; one that is absent or "auto" equals the other.
  absl::Status ReadRadii(Vec2d& radii) const {
    constexpr std::array<std::pair<const char*, Along>, 2> kNames = {{{"rx", Along::kX}, {"ry", Along::kY}}};
    std::array<bool, 2> given{};
    for (size_t m = 0; m < 2; ++m) {
      const auto& [name, along] = kNames[m];
      given[m] = node_.attribute(name) && absl::StripAsciiWhitespace(node_.attribute(name).value()) != "auto";
      if (!given[m]) continue;
      if (auto status = ReadLength(node_, name, along, viewport_, radii[m]); !status.ok()) return status;
      if (radii[m] < 0) return Bad("has a negative radius");
    }
    if (!given[0]) radii[0] = radii[1];
    if (!given[1]) radii[1] = radii[0];
    return absl::OkStatus();
  }

  absl::Status ReadEllipse(bool is_circle) {
    Vec2d center{}, radii{};
    if (auto status = ReadLength(node_, "cx", Along::kX, viewport_, center[0]); !status.ok()) return status;
    if (auto status = ReadLength(node_, "cy", Along::kY, viewport_, center[1]); !status.ok()) return status;
    if (is_circle) {
      if (auto status = ReadLength(node_, "r", Along::kBoth, viewport_, radii[0]); !status.ok()) return status;
      if (radii[0] < 0) return Bad("has a negative radius");
      radii[1] = radii[0];
    } else if (auto status = ReadRadii(radii); !status.ok()) {
      return status;
    }
    if (radii[0] > 0 && radii[1] > 0) outlines_.push_back(EllipseOutline(center, radii));
    return absl::OkStatus();
  }

  absl::Status ReadRect() {
    Vec2d low{}, size{}, radii{};
    const std::tuple<const char*, Along, double*> kLengths[] = {{"x", Along::kX, &low[0]},
                                                                {"y", Along::kY, &low[1]},
                                                                {"width", Along::kX, &size[0]},
                                                                {"height", Along::kY, &size[1]}};
    for (const auto& [name, along, value] : kLengths) {
      if (auto status = ReadLength(node_, name, along, viewport_, *value); !status.ok()) return status;
    }
    if (size[0] < 0 || size[1] < 0) return Bad("has a negative size");
    if (auto status = ReadRadii(radii); !status.ok()) return status;
    if (size[0] > 0 && size[1] > 0) AddRect(low, {low[0] + size[0], low[1] + size[1]}, radii);
    return absl::OkStatus();
  }

  // Goes around as the standard does: toward greater x first, from behind the first corner on.
  void AddRect(const Vec2d& low, const Vec2d& high, const Vec2d& radii) {
    const double rx = std::min(radii[0], (high[0] - low[0]) / 2), ry = std::min(radii[1], (high[1] - low[1]) / 2);
    if (rx == 0 || ry == 0) return AddOutline({low, {high[0], low[1]}, high, {low[0], high[1]}}, /*closed=*/true);
    Outline outline{{low[0] + rx, low[1]}, {}, true};
    const std::array<std::pair<Vec2d, Vec2d>, 4> corners = {{{{high[0] - rx, low[1]}, {high[0], low[1] + ry}},
                                                             {{high[0], high[1] - ry}, {high[0] - rx, high[1]}},
                                                             {{low[0] + rx, high[1]}, {low[0], high[1] - ry}},
                                                             {{low[0], low[1] + ry}, {low[0] + rx, low[1]}}}};
    for (const auto& [before, behind] : corners) {
      outline.pieces.push_back({1, {before}});
      AppendArc(before, {.radii = {rx, ry}, .sweep = true, .end = behind}, outline.pieces);
    }
    outlines_.push_back(std::move(outline));
  }

  void AddOutline(const std::vector<Vec2d>& points, bool closed) {
    if (points.size() < 2) return;
    Outline& outline = outlines_.emplace_back();
    outline.start = points[0];
    outline.closed = closed;
    for (size_t n = 1; n < points.size(); ++n) outline.pieces.push_back({1, {points[n]}});
  }

  const pugi::xml_node& node_;
  const Viewport& viewport_;
  std::vector<Outline>& outlines_;
};

}  // namespace

absl::Status AppendShape(const pugi::xml_node& node, absl::string_view name, const Viewport& viewport,
                         std::vector<Outline>& outlines) {
  return ShapeReader(node, viewport, outlines).Append(name);
}

}  // namespace latvox::client
