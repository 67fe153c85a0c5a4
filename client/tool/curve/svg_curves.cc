#include "client/tool/curve/svg_curves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <tuple>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "client/tool/curve/scan.h"
#include "client/tool/curve/svg_arc.h"
#include "client/tool/curve/svg_path.h"
#include "client/tool/curve/svg_transform.h"

namespace latvox::client {
namespace {

constexpr int kMaxDepth = 256;              // nesting of elements and of uses
constexpr size_t kMaxElements = 1'000'000;  // with each use of an element
constexpr size_t kMaxPieces = 10'000'000;   // of all outlines

// The box that percentages refer to, and that a nested drawing fills. Absent: the drawing does not tell.
struct Viewport {
  std::optional<double> width, height;
};

// The direction that a percentage of the viewport refers to.
enum class Along { kX, kY, kBoth };

// User units in one, at 96 dots an inch.
constexpr std::pair<absl::string_view, double> kUnits[] = {{"", 1},           {"px", 1},         {"in", 96},
                                                           {"cm", 96 / 2.54}, {"mm", 96 / 25.4}, {"q", 96 / 101.6},
                                                           {"pt", 96.0 / 72}, {"pc", 16}};

// Elements that draw nothing where they stand.
constexpr absl::string_view kSilent[] = {
    "title",   "desc",          "metadata",         "defs",   "style", "script",         "symbol",         "clipPath",
    "mask",    "marker",        "pattern",          "filter", "font",  "linearGradient", "radialGradient", "view",
    "animate", "animateMotion", "animateTransform", "set",    "cursor"};

struct ViewBox {
  Vec2d low, size;
};

// Returns nothing without four numbers, or without a size.
std::optional<ViewBox> ParseViewBox(absl::string_view text) {
  std::vector<double> n;
  if (!ParseNumbers(text, n) || n.size() != 4 || !(n[2] > 0) || !(n[3] > 0)) return std::nullopt;
  return ViewBox{{n[0], n[1]}, {n[2], n[3]}};
}

// Returns the transform of a view box onto a viewport: SVG 2, "The preserveAspectRatio attribute".
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
    FindIds(root);
    Place place{{}, RootViewport(root), 0};
    if (auto status = ReadTransform(root, place.transform); !status.ok()) return status;
    if (auto status = ReadChildren(root, place); !status.ok()) return status;
    return FlattenAll();
  }

 private:
  static absl::string_view NameOf(const pugi::xml_node& node) { return absl::StripPrefix(node.name(), "svg:"); }

  size_t LineAt(std::ptrdiff_t offset) const {
    const auto end = std::clamp<std::ptrdiff_t>(offset, 0, static_cast<std::ptrdiff_t>(text_.size()));
    return 1 + static_cast<size_t>(std::count(text_.begin(), text_.begin() + end, '\n'));
  }

  // Of elements with one ID, the first counts.
  void FindIds(const pugi::xml_node& root) {
    for (pugi::xml_node node = root; node;) {
      if (const char* const id = node.attribute("id").value(); *id != '\0') ids_.try_emplace(id, node);
      if (node.first_child()) {
        node = node.first_child();
        continue;
      }
      while (node && node != root && !node.next_sibling()) node = node.parent();
      node = node == root ? pugi::xml_node() : node.next_sibling();
    }
  }

  template <class... Parts>
  absl::Status Error(const pugi::xml_node& node, const Parts&... parts) const {
    return absl::InvalidArgumentError(
        absl::StrCat("line ", LineAt(node.offset_debug()), ": <", node.name(), "> ", parts...));
  }

  absl::Status ReadTransform(const pugi::xml_node& node, Affine& transform) const {
    const auto own = ParseTransforms(node.attribute("transform").value());
    if (!own.ok()) return Error(node, own.status().message());
    transform = Compose(transform, *own);
    return absl::OkStatus();
  }

  static bool IsHidden(const pugi::xml_node& node) {
    if (absl::StripAsciiWhitespace(node.attribute("display").value()) == "none") return true;
    for (const absl::string_view rule : absl::StrSplit(node.attribute("style").value(), ';')) {
      const std::pair<absl::string_view, absl::string_view> pair = absl::StrSplit(rule, absl::MaxSplits(':', 1));
      if (absl::StripAsciiWhitespace(pair.first) == "display" && absl::StripAsciiWhitespace(pair.second) == "none") {
        return true;
      }
    }
    return false;
  }

  // What an element inherits.
  struct Place {
    Affine transform = {};
    Viewport viewport = {};
    int depth = 0;
  };

  absl::Status ReadChildren(const pugi::xml_node& node, const Place& place) {
    for (const pugi::xml_node& child : node.children()) {
      if (child.type() != pugi::node_element) continue;
      if (auto status = ReadElement(child, place); !status.ok()) return status;
    }
    return absl::OkStatus();
  }

  absl::Status ReadElement(const pugi::xml_node& node, Place place) {
    const absl::string_view name = NameOf(node);
    if (absl::StrContains(name, ':') || std::ranges::find(kSilent, name) != std::end(kSilent) || IsHidden(node)) {
      return absl::OkStatus();
    }
    if (++place.depth > kMaxDepth) {
      return Error(node, "is nested ", place.depth, " levels deep; the limit is ", kMaxDepth);
    }
    if (++elements_ > kMaxElements)
      return Error(node, "exceeds the limit of ", kMaxElements, " elements, uses included");
    if (auto status = ReadTransform(node, place.transform); !status.ok()) return status;
    if (name == "g" || name == "a") return ReadChildren(node, place);
    if (name == "switch") return ReadSwitch(node, place);
    if (name == "use") return ReadUse(node, place);
    if (name == "svg") return ReadNested(node, node, place);
    return ReadShapeAt(node, name, place);
  }

  // Reads the first child that asks for nothing this reader lacks, as programs write them.
  absl::Status ReadSwitch(const pugi::xml_node& node, const Place& place) {
    for (const pugi::xml_node& child : node.children()) {
      const absl::string_view language = child.attribute("systemLanguage").value();
      if (child.type() == pugi::node_element && *child.attribute("requiredExtensions").value() == '\0' &&
          (language.empty() || absl::StartsWith(language, "en"))) {
        return ReadElement(child, place);
      }
    }
    return absl::OkStatus();
  }

  absl::Status ReadUse(const pugi::xml_node& node, Place place) {
    pugi::xml_attribute link = node.attribute("href");
    if (!link) link = node.attribute("xlink:href");
    const absl::string_view target = link.value();
    const auto found = absl::StartsWith(target, "#") ? ids_.find(target.substr(1)) : ids_.end();
    if (found == ids_.end()) return Error(node, "href \"", target, "\" is not #ID of an element of this drawing");
    double x = 0, y = 0;
    if (auto status = ReadLength(node, "x", Along::kX, place.viewport, x); !status.ok()) return status;
    if (auto status = ReadLength(node, "y", Along::kY, place.viewport, y); !status.ok()) return status;
    place.transform = Compose(place.transform, {1, 0, 0, 1, x, y});
    const absl::string_view name = NameOf(found->second);
    if (name != "symbol" && name != "svg") return ReadElement(found->second, place);
    if (auto status = ReadTransform(found->second, place.transform); !status.ok()) return status;
    if (++place.depth > kMaxDepth)
      return Error(node, "is nested ", place.depth, " levels deep; the limit is ", kMaxDepth);
    return ReadNested(found->second, node, place);
  }

  // Reads a drawing within a drawing. `sized`: the element whose width and height count, if it has them.
  absl::Status ReadNested(const pugi::xml_node& node, const pugi::xml_node& sized, Place place) {
    Viewport inner = place.viewport;  // 100 % is the default
    Vec2d corner{};
    for (const auto& [name, along, side] :
         {std::tuple("width", Along::kX, &inner.width), std::tuple("height", Along::kY, &inner.height)}) {
      const pugi::xml_node& source = sized.attribute(name) ? sized : node;
      if (!source.attribute(name)) continue;
      if (auto status = ReadLength(source, name, along, place.viewport, side->emplace()); !status.ok()) return status;
      if (**side < 0) return Error(source, "has a negative size");
    }
    if (auto status = ReadLength(node, "x", Along::kX, place.viewport, corner[0]); !status.ok()) return status;
    if (auto status = ReadLength(node, "y", Along::kY, place.viewport, corner[1]); !status.ok()) return status;
    if (inner.width == 0 || inner.height == 0) return absl::OkStatus();
    place.transform = Compose(place.transform, {1, 0, 0, 1, corner[0], corner[1]});
    place.viewport = inner;
    if (const pugi::xml_attribute attribute = node.attribute("viewBox")) {
      const auto view = ParseViewBox(attribute.value());
      if (!view) {
        return Error(node, "viewBox \"", attribute.value(), "\" is not x, y, a width and a height above 0");
      }
      if (!inner.width || !inner.height)
        return Error(node, "needs width and height, or a viewBox of the whole drawing");
      place.transform = Compose(place.transform, FitViewBox(*view, {*inner.width, *inner.height},
                                                            node.attribute("preserveAspectRatio").value()));
      place.viewport = {view->size[0], view->size[1]};
    }
    return ReadChildren(node, place);
  }

  // The root's viewBox only tells what percentages mean: world coordinates are the numbers of the drawing.
  Viewport RootViewport(const pugi::xml_node& root) const {
    if (const auto view = ParseViewBox(root.attribute("viewBox").value())) return {view->size[0], view->size[1]};
    Viewport viewport;
    for (const auto& [name, side] : {std::pair("width", &viewport.width), std::pair("height", &viewport.height)}) {
      double length = 0;
      if (root.attribute(name) && ReadLength(root, name, Along::kBoth, {}, length).ok()) *side = length;
    }
    return viewport;
  }

  absl::Status ReadShapeAt(const pugi::xml_node& node, absl::string_view name, const Place& place) {
    const size_t first = outlines_.size();
    if (auto status = ReadShape(node, name, place.viewport); !status.ok()) return status;
    for (size_t n = first; n < outlines_.size(); ++n) {
      outlines_[n].start = place.transform(outlines_[n].start);
      for (OutlinePiece& piece : outlines_[n].pieces) {
        for (Vec2d& p : piece.control) p = place.transform(p);
      }
      pieces_ += outlines_[n].pieces.size();
    }
    if (pieces_ > kMaxPieces)
      return Error(node, "exceeds the limit of ", kMaxPieces, " lines and curves, uses included");
    return absl::OkStatus();
  }

  absl::Status ReadShape(const pugi::xml_node& node, absl::string_view name, const Viewport& viewport) {
    if (name == "polyline") return ReadPoints(node, /*closed=*/false);
    if (name == "polygon") return ReadPoints(node, /*closed=*/true);
    if (name == "line") return ReadLine(node, viewport);
    if (name == "rect") return ReadRect(node, viewport);
    if (name == "circle" || name == "ellipse") return ReadEllipse(node, name == "circle", viewport);
    if (name == "text") return Error(node, "has no outlines; convert text to paths");
    if (name != "path") {
      return Error(node, "is not one of svg, g, a, switch, use, polyline, polygon, line, rect, circle, ellipse, path");
    }
    const auto status = ParsePathData(node.attribute("d").value(), outlines_);
    return status.ok() ? status : Error(node, status.message());
  }

  // Leaves `value` if the attribute is absent.
  absl::Status ReadLength(const pugi::xml_node& node, const char* name, Along along, const Viewport& viewport,
                          double& value) const {
    const pugi::xml_attribute attribute = node.attribute(name);
    if (!attribute) return absl::OkStatus();
    absl::string_view text = absl::StripAsciiWhitespace(attribute.value());
    double number = 0;
    const auto refusal = [&](absl::string_view why) { return Error(node, name, " \"", attribute.value(), "\" ", why); };
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

  absl::Status ReadLine(const pugi::xml_node& node, const Viewport& viewport) {
    std::array<Vec2d, 2> ends{};
    constexpr const char* kNames[2][2] = {{"x1", "y1"}, {"x2", "y2"}};
    for (size_t n = 0; n < 2; ++n) {
      for (size_t m = 0; m < 2; ++m) {
        const Along along = m == 0 ? Along::kX : Along::kY;
        if (auto status = ReadLength(node, kNames[n][m], along, viewport, ends[n][m]); !status.ok()) return status;
      }
    }
    AddOutline({ends[0], ends[1]}, /*closed=*/false);
    return absl::OkStatus();
  }

  // Reads rx and ry; one that is absent or "auto" equals the other.
  absl::Status ReadRadii(const pugi::xml_node& node, const Viewport& viewport, Vec2d& radii) const {
    constexpr std::array<std::pair<const char*, Along>, 2> kNames = {{{"rx", Along::kX}, {"ry", Along::kY}}};
    std::array<bool, 2> given{};
    for (size_t m = 0; m < 2; ++m) {
      const auto& [name, along] = kNames[m];
      given[m] = node.attribute(name) && absl::StripAsciiWhitespace(node.attribute(name).value()) != "auto";
      if (!given[m]) continue;
      if (auto status = ReadLength(node, name, along, viewport, radii[m]); !status.ok()) return status;
      if (radii[m] < 0) return Error(node, "has a negative radius");
    }
    if (!given[0]) radii[0] = radii[1];
    if (!given[1]) radii[1] = radii[0];
    return absl::OkStatus();
  }

  absl::Status ReadEllipse(const pugi::xml_node& node, bool is_circle, const Viewport& viewport) {
    Vec2d center{}, radii{};
    if (auto status = ReadLength(node, "cx", Along::kX, viewport, center[0]); !status.ok()) return status;
    if (auto status = ReadLength(node, "cy", Along::kY, viewport, center[1]); !status.ok()) return status;
    if (is_circle) {
      if (auto status = ReadLength(node, "r", Along::kBoth, viewport, radii[0]); !status.ok()) return status;
      if (radii[0] < 0) return Error(node, "has a negative radius");
      radii[1] = radii[0];
    } else if (auto status = ReadRadii(node, viewport, radii); !status.ok()) {
      return status;
    }
    if (radii[0] > 0 && radii[1] > 0) outlines_.push_back(EllipseOutline(center, radii));
    return absl::OkStatus();
  }

  absl::Status ReadRect(const pugi::xml_node& node, const Viewport& viewport) {
    Vec2d low{}, size{}, radii{};
    const std::tuple<const char*, Along, double*> kLengths[] = {{"x", Along::kX, &low[0]},
                                                                {"y", Along::kY, &low[1]},
                                                                {"width", Along::kX, &size[0]},
                                                                {"height", Along::kY, &size[1]}};
    for (const auto& [name, along, value] : kLengths) {
      if (auto status = ReadLength(node, name, along, viewport, *value); !status.ok()) return status;
    }
    if (size[0] < 0 || size[1] < 0) return Error(node, "has a negative size");
    if (auto status = ReadRadii(node, viewport, radii); !status.ok()) return status;
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
  absl::flat_hash_map<absl::string_view, pugi::xml_node> ids_;  // of the document
  std::vector<Outline> outlines_;
  size_t elements_ = 0, pieces_ = 0;  // so far
};

}  // namespace

absl::StatusOr<std::vector<Polyline>> ParseSvg(absl::string_view text) { return SvgReader(text).Read(); }

}  // namespace latvox::client
