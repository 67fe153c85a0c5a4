#include "client/tool/curve/svg_curves.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <pugixml.hpp>
#include <string>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "client/tool/curve/scan.h"
#include "client/tool/curve/svg_path.h"

namespace latvox::client {
namespace {

constexpr int kMaxDepth = 256;  // nesting of groups

// x' = a*x + c*y + e,  y' = b*x + d*y + f
struct Affine {
  double a = 1, b = 0, c = 0, d = 1, e = 0, f = 0;

  Vec2d operator()(const Vec2d& p) const { return {a * p[0] + c * p[1] + e, b * p[0] + d * p[1] + f}; }
};

// Returns the transform that applies `inner` first, then `outer`.
Affine Compose(const Affine& outer, const Affine& inner) {
  const auto linear = [&](double x, double y) { return Vec2d{outer.a * x + outer.c * y, outer.b * x + outer.d * y}; };
  const Vec2d i = linear(inner.a, inner.b), j = linear(inner.c, inner.d), o = outer({inner.e, inner.f});
  return {i[0], i[1], j[0], j[1], o[0], o[1]};
}

// Reads all numbers of a list separated by white space or commas. Returns false at anything else.
bool ParseNumbers(absl::string_view text, std::vector<double>& numbers) {
  SkipSpace(text);
  while (!text.empty()) {
    if (!ReadDecimal(text, numbers.emplace_back())) return false;
    SkipSeparator(text);
  }
  return true;
}

// Reads "name(numbers)". Returns false if the name needs another number of numbers.
bool MakeTransform(absl::string_view name, const std::vector<double>& n, Affine& transform) {
  if (name == "translate" && (n.size() == 1 || n.size() == 2)) {
    transform = {1, 0, 0, 1, n[0], n.size() == 2 ? n[1] : 0};
  } else if (name == "scale" && (n.size() == 1 || n.size() == 2)) {
    transform = {n[0], 0, 0, n.back(), 0, 0};
  } else if (name == "matrix" && n.size() == 6) {
    transform = {n[0], n[1], n[2], n[3], n[4], n[5]};
  } else {
    return false;
  }
  return true;
}

class SvgReader {
 public:
  explicit SvgReader(absl::string_view text) : text_(text) {}

  absl::StatusOr<std::vector<Polyline>> Read() {
    pugi::xml_document document;
    const pugi::xml_parse_result result = document.load_buffer(text_.data(), text_.size());
    if (!result) {
      return absl::InvalidArgumentError(
          absl::StrCat("line ", LineAt(result.offset), ": is not XML (", result.description(), ")"));
    }
    const pugi::xml_node root = document.document_element();
    if (NameOf(root) != "svg") return Error(root, "is not svg, the root of a drawing");
    if (auto status = ReadChildren(root, {}, 0); !status.ok()) return status;
    return FlattenAll();
  }

 private:
  static absl::string_view NameOf(const pugi::xml_node& node) { return absl::StripPrefix(node.name(), "svg:"); }

  size_t LineAt(std::ptrdiff_t offset) const {
    const auto end = std::clamp<std::ptrdiff_t>(offset, 0, static_cast<std::ptrdiff_t>(text_.size()));
    return 1 + static_cast<size_t>(std::count(text_.begin(), text_.begin() + end, '\n'));
  }

  template <class... Parts>
  absl::Status Error(const pugi::xml_node& node, const Parts&... parts) const {
    return absl::InvalidArgumentError(
        absl::StrCat("line ", LineAt(node.offset_debug()), ": <", node.name(), "> ", parts...));
  }

  absl::Status ReadTransform(const pugi::xml_node& node, Affine& transform) const {
    for (absl::string_view rest = node.attribute("transform").value(); SkipSeparator(rest), !rest.empty();) {
      const size_t open = rest.find('('), close = rest.find(')');
      const absl::string_view name = absl::StripAsciiWhitespace(rest.substr(0, open));
      Affine one;
      std::vector<double> numbers;
      if (open == absl::string_view::npos || close == absl::string_view::npos || close < open ||
          !ParseNumbers(rest.substr(open + 1, close - open - 1), numbers) || !MakeTransform(name, numbers, one)) {
        return Error(node, "transform \"", rest, "\" does not begin with translate(x,y), scale(x,y) or matrix(6)");
      }
      transform = Compose(transform, one);
      rest.remove_prefix(close + 1);
    }
    return absl::OkStatus();
  }

  absl::Status ReadChildren(const pugi::xml_node& node, Affine transform, int depth) {
    if (depth > kMaxDepth) return Error(node, "is nested ", depth, " levels deep; the limit is ", kMaxDepth);
    if (auto status = ReadTransform(node, transform); !status.ok()) return status;
    for (const pugi::xml_node& child : node.children()) {
      if (child.type() != pugi::node_element) continue;
      if (auto status = ReadElement(child, transform, depth); !status.ok()) return status;
    }
    return absl::OkStatus();
  }

  absl::Status ReadElement(const pugi::xml_node& node, Affine transform, int depth) {
    const absl::string_view name = NameOf(node);
    if (absl::StrContains(name, ':')) return absl::OkStatus();
    for (const char* silent : {"title", "desc", "metadata", "defs", "style"}) {
      if (name == silent) return absl::OkStatus();
    }
    if (name == "g") return ReadChildren(node, transform, depth + 1);
    if (auto status = ReadTransform(node, transform); !status.ok()) return status;
    const size_t first = outlines_.size();
    if (auto status = ReadShape(node, name); !status.ok()) return status;
    for (size_t n = first; n < outlines_.size(); ++n) {
      outlines_[n].start = transform(outlines_[n].start);
      for (OutlinePiece& piece : outlines_[n].pieces) {
        for (Vec2d& p : piece.control) p = transform(p);
      }
    }
    return absl::OkStatus();
  }

  absl::Status ReadShape(const pugi::xml_node& node, absl::string_view name) {
    if (name == "polyline") return ReadPoints(node, /*closed=*/false);
    if (name == "polygon") return ReadPoints(node, /*closed=*/true);
    if (name == "line") return ReadLine(node);
    if (name == "rect") return ReadRect(node);
    if (name != "path") return Error(node, "is not one of svg, g, polyline, polygon, line, rect, path");
    const auto status = ParsePathData(node.attribute("d").value(), outlines_);
    return status.ok() ? status : Error(node, status.message());
  }

  absl::Status ReadNumber(const pugi::xml_node& node, const char* name, double& value) const {
    const pugi::xml_attribute attribute = node.attribute(name);
    if (!attribute) return absl::OkStatus();
    absl::string_view text = absl::StripAsciiWhitespace(attribute.value());
    if (ReadDecimal(text, value) && text.empty()) return absl::OkStatus();
    return Error(node, name, " \"", attribute.value(), "\" is not a finite number without a unit");
  }

  absl::Status ReadPoints(const pugi::xml_node& node, bool closed) {
    std::vector<double> numbers;
    if (!ParseNumbers(node.attribute("points").value(), numbers) || numbers.size() % 2 != 0) {
      return Error(node, "points are not pairs of finite numbers");
    }
    std::vector<Vec2d> points;
    for (size_t n = 0; n < numbers.size(); n += 2) points.push_back({numbers[n], numbers[n + 1]});
    AddOutline(points, closed);
    return absl::OkStatus();
  }

  absl::Status ReadLine(const pugi::xml_node& node) {
    std::array<Vec2d, 2> ends{};
    constexpr const char* kNames[2][2] = {{"x1", "y1"}, {"x2", "y2"}};
    for (size_t n = 0; n < 2; ++n) {
      for (size_t m = 0; m < 2; ++m) {
        if (auto status = ReadNumber(node, kNames[n][m], ends[n][m]); !status.ok()) return status;
      }
    }
    AddOutline({ends[0], ends[1]}, /*closed=*/false);
    return absl::OkStatus();
  }

  absl::Status ReadRect(const pugi::xml_node& node) {
    std::array<double, 6> values{};
    constexpr std::array<const char*, 6> kNames = {"x", "y", "width", "height", "rx", "ry"};
    for (size_t n = 0; n < kNames.size(); ++n) {
      if (auto status = ReadNumber(node, kNames[n], values[n]); !status.ok()) return status;
    }
    const auto& [x, y, width, height, rx, ry] = values;
    if (width < 0 || height < 0) return Error(node, "has a negative size");
    if (rx != 0 || ry != 0) return Error(node, "with round corners (rx, ry) is not supported");
    if (width > 0 && height > 0) {
      AddOutline({{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}}, /*closed=*/true);
    }
    return absl::OkStatus();
  }

  void AddOutline(const std::vector<Vec2d>& points, bool closed) {
    if (points.size() < 2) return;
    Outline& outline = outlines_.emplace_back();
    outline.start = points[0];
    outline.closed = closed;
    for (size_t n = 1; n < points.size(); ++n) outline.pieces.push_back({1, {points[n]}});
  }

  absl::StatusOr<std::vector<Polyline>> FlattenAll() const {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Vec2d low = {kInfinity, kInfinity}, high = {-kInfinity, -kInfinity};
    bool finite = true;
    const auto extend = [&](const Vec2d& p) {
      for (size_t m = 0; m < 2; ++m) {
        finite = finite && std::isfinite(p[m]);
        low[m] = std::min(low[m], p[m]);
        high[m] = std::max(high[m], p[m]);
      }
    };
    for (const Outline& outline : outlines_) {
      extend(outline.start);
      for (const OutlinePiece& piece : outline.pieces) {
        for (size_t n = 0; n < piece.degree; ++n) extend(piece.control[n]);
      }
    }
    const double side = std::max(high[0] - low[0], high[1] - low[1]);
    if (!outlines_.empty() && !(finite && std::isfinite(side))) {
      return absl::InvalidArgumentError("coordinates are not finite after the transform");
    }
    std::vector<Polyline> polylines;
    for (const Outline& outline : outlines_) {
      polylines.push_back(Flatten(outline, std::max(side * kFlatness, std::numeric_limits<double>::min())));
    }
    return polylines;
  }

  const absl::string_view text_;
  std::vector<Outline> outlines_;
};

}  // namespace

absl::StatusOr<std::vector<Polyline>> ParseSvg(absl::string_view text) { return SvgReader(text).Read(); }

}  // namespace latvox::client
