#include "client/tool/curve/svg_curves.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <tuple>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "client/tool/curve/svg_entities.h"
#include "client/tool/curve/svg_names.h"
#include "client/tool/curve/svg_path.h"
#include "client/tool/curve/svg_shapes.h"
#include "client/tool/curve/svg_style.h"
#include "client/tool/curve/svg_transform.h"
#include "client/tool/curve/svg_viewport.h"

namespace latvox::client {
namespace {

constexpr int kMaxDepth = 256;              // nesting of elements and of uses
constexpr size_t kMaxElements = 1'000'000;  // with each use of an element
constexpr size_t kMaxPieces = 10'000'000;   // of all outlines

constexpr char kForeignSheet[] = "has a style sheet of its own file, which is not read; write it into <style>";

// Elements that draw nothing where they stand.
constexpr absl::string_view kSilent[] = {
    "title",   "desc",          "metadata",         "defs",   "style", "script",         "symbol",         "clipPath",
    "mask",    "marker",        "pattern",          "filter", "font",  "linearGradient", "radialGradient", "view",
    "animate", "animateMotion", "animateTransform", "set",    "cursor"};

class SvgReader {
 public:
  explicit SvgReader(absl::string_view text) : text_(text) {}

  absl::StatusOr<std::vector<Polyline>> Read() {
    pugi::xml_document document;
    const pugi::xml_parse_result result =
        document.load_buffer(text_.data(), text_.size(), pugi::parse_default | pugi::parse_pi);
    if (!result) {
      return absl::InvalidArgumentError(
          absl::StrCat("line ", LineAt(result.offset), ": is not XML (", result.description(), ")"));
    }
    foreign_ = ResolveNames(document);
    const pugi::xml_node root = document.document_element();
    if (NameOf(root) != "svg" || IsForeign(root)) {
      return Error(root, "is not svg, the root of a drawing, in the namespace ", kSvgNamespace, " or in none");
    }
    if (auto status = ApplyStyles(document, root); !status.ok()) return status;
    Place place{{}, RootViewport(root)};
    ReadVisibility(root, place);
    if (!IsHidden(root)) {
      if (auto status = ReadTransform(root, place); !status.ok()) return status;
      if (auto status = ReadChildren(root, place); !status.ok()) return status;
    }
    return FlattenAll();
  }

 private:
  static absl::string_view NameOf(const pugi::xml_node& node) { return node.name(); }

  bool IsForeign(const pugi::xml_node& node) const { return foreign_.contains(node.internal_object()); }

  size_t LineAt(std::ptrdiff_t offset) const {
    const auto end = std::clamp<std::ptrdiff_t>(offset, 0, static_cast<std::ptrdiff_t>(text_.size()));
    return 1 + static_cast<size_t>(std::count(text_.begin(), text_.begin() + end, '\n'));
  }

  static std::vector<pugi::xml_node> AllElements(const pugi::xml_node& root) {
    std::vector<pugi::xml_node> elements;
    for (pugi::xml_node node = root; node;) {
      if (node.type() == pugi::node_element) elements.push_back(node);
      if (node.first_child()) {
        node = node.first_child();
        continue;
      }
      while (node && node != root && !node.next_sibling()) node = node.parent();
      node = node == root ? pugi::xml_node() : node.next_sibling();
    }
    return elements;
  }

  // Only HTML has this element: its prefix may be any.
  static bool IsSheetLink(const pugi::xml_node& node) {
    const absl::string_view name = node.name();
    return (name == "link" || absl::EndsWith(name, ":link")) &&
           absl::StrContains(absl::AsciiStrToLower(node.attribute("rel").value()), "stylesheet");
  }

  // Finds IDs, too: the first element with an ID counts.
  absl::Status ApplyStyles(const pugi::xml_document& document, const pugi::xml_node& root) {
    for (const pugi::xml_node& node : document.children()) {
      if (node.type() == pugi::node_pi && absl::string_view(node.name()) == "xml-stylesheet") {
        return Error(root, kForeignSheet);
      }
    }
    const std::vector<pugi::xml_node> elements = AllElements(root);
    SvgStyles styles;
    for (const pugi::xml_node& node : elements) {
      if (const char* const id = node.attribute("id").value(); *id != '\0') ids_.try_emplace(id, node);
      if (IsSheetLink(node)) return Error(node, kForeignSheet);
      if (NameOf(node) != "style") continue;
      if (auto status = styles.AddSheet(node); !status.ok()) return Error(node, status.message());
    }
    for (const pugi::xml_node& node : elements) {
      if (auto status = styles.Apply(node, NameOf(node)); !status.ok()) return Error(node, status.message());
    }
    return absl::OkStatus();
  }

  template <class... Parts>
  absl::Status Error(const pugi::xml_node& node, const Parts&... parts) const {
    return absl::InvalidArgumentError(
        absl::StrCat("line ", LineAt(node.offset_debug()), ": <", node.name(), "> ", parts...));
  }

  // The state that an element inherits.
  struct Place {
    Affine transform = {};
    Viewport viewport = {};
    bool is_visible = true;
    int depth = 0;
  };

  // Appends the element's transform to that of its place.
  absl::Status ReadTransform(const pugi::xml_node& node, Place& place) const {
    const absl::string_view transforms = node.attribute("transform").value();
    if (transforms.empty()) return absl::OkStatus();
    const auto own = ParseTransforms(transforms, place.viewport);
    if (!own.ok()) return Error(node, own.status().message());
    const absl::string_view box = absl::StripAsciiWhitespace(node.attribute("transform-box").value());
    if (!box.empty() && box != "view-box") {
      return Error(node, "has transform-box \"", box, "\"; only view-box, the default, is read");
    }
    Vec2d origin{};
    if (const pugi::xml_attribute attribute = node.attribute("transform-origin")) {
      const auto given = ParseOrigin(attribute.value(), place.viewport);
      if (!given.ok()) return Error(node, given.status().message());
      origin = *given;
    }
    const Affine around =
        Compose(Compose(Translation(origin[0], origin[1]), *own), Translation(-origin[0], -origin[1]));
    place.transform = Compose(place.transform, around);
    return absl::OkStatus();
  }

  static bool IsHidden(const pugi::xml_node& node) {
    return absl::EqualsIgnoreCase(absl::StripAsciiWhitespace(node.attribute("display").value()), "none");
  }

  // An element may be visible in one that is not.
  static void ReadVisibility(const pugi::xml_node& node, Place& place) {
    const absl::string_view word = absl::StripAsciiWhitespace(node.attribute("visibility").value());
    if (absl::EqualsIgnoreCase(word, "visible")) place.is_visible = true;
    if (absl::EqualsIgnoreCase(word, "hidden") || absl::EqualsIgnoreCase(word, "collapse")) place.is_visible = false;
  }

  absl::Status ReadChildren(const pugi::xml_node& node, const Place& place) {
    for (const pugi::xml_node& child : node.children()) {
      if (child.type() != pugi::node_element) continue;
      if (auto status = ReadElement(child, place); !status.ok()) return status;
    }
    return absl::OkStatus();
  }

  // Counts an element, and each use of one, and takes it into its place.
  absl::Status Enter(const pugi::xml_node& node, Place& place) {
    if (++place.depth > kMaxDepth) {
      return Error(node, "is nested ", place.depth, " levels deep; the limit is ", kMaxDepth);
    }
    if (++elements_ > kMaxElements) {
      return Error(node, "exceeds the limit of ", kMaxElements, " elements, uses included");
    }
    ReadVisibility(node, place);
    return ReadTransform(node, place);
  }

  absl::Status ReadElement(const pugi::xml_node& node, Place place) {
    const absl::string_view name = NameOf(node);
    if (IsForeign(node) || std::ranges::find(kSilent, name) != std::end(kSilent) || IsHidden(node)) {
      return absl::OkStatus();
    }
    if (auto status = Enter(node, place); !status.ok()) return status;
    if (name == "g" || name == "a") return ReadChildren(node, place);
    if (name == "switch") return ReadSwitch(node, place);
    if (name == "use") return ReadUse(node, place);
    if (name == "svg") return ReadNested(node, node, place);
    return ReadShapeAt(node, name, place);
  }

  // Reads the first child without a condition that this reader fails.
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
    if (auto status = MoveTo(node, place); !status.ok()) return status;
    const absl::string_view name = NameOf(found->second);
    if (name != "symbol" && name != "svg") return ReadElement(found->second, place);
    if (IsHidden(found->second)) return absl::OkStatus();
    if (auto status = Enter(found->second, place); !status.ok()) return status;
    return ReadNested(found->second, node, place);
  }

  // Moves the place by the attributes x and y.
  absl::Status MoveTo(const pugi::xml_node& node, Place& place) const {
    Vec2d corner{};
    for (const auto& [name, along, value] :
         {std::tuple("x", Along::kX, &corner[0]), std::tuple("y", Along::kY, &corner[1])}) {
      if (auto status = ReadLength(node, name, along, place.viewport, *value); !status.ok()) {
        return Error(node, status.message());
      }
    }
    place.transform = Compose(place.transform, Translation(corner[0], corner[1]));
    return absl::OkStatus();
  }

  // Reads a drawing within a drawing. `sized`: the element whose width and height count, if it has them.
  absl::Status ReadNested(const pugi::xml_node& node, const pugi::xml_node& sized, Place place) {
    Viewport inner = place.viewport;  // 100 % is the default
    for (const auto& [name, along, side] :
         {std::tuple("width", Along::kX, &inner.width), std::tuple("height", Along::kY, &inner.height)}) {
      const pugi::xml_node& source = sized.attribute(name) ? sized : node;
      if (!source.attribute(name)) continue;
      if (auto status = ReadLength(source, name, along, place.viewport, side->emplace()); !status.ok()) {
        return Error(source, status.message());
      }
      if (**side < 0) return Error(source, "has a negative size");
    }
    if (inner.width == 0 || inner.height == 0) return absl::OkStatus();
    if (auto status = MoveTo(node, place); !status.ok()) return status;
    place.viewport = inner;
    if (const pugi::xml_attribute attribute = node.attribute("viewBox")) {
      const auto view = ParseViewBox(attribute.value());
      if (!view) {
        return Error(node, "viewBox \"", attribute.value(), "\" is not x, y, a width and a height above 0");
      }
      if (!inner.width || !inner.height) {
        return Error(node, "needs width and height, or a viewBox of the whole drawing");
      }
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
    if (auto status = AppendShape(node, name, place.viewport, outlines_); !status.ok()) {
      return Error(node, status.message());
    }
    if (!place.is_visible) outlines_.resize(first);
    for (size_t n = first; n < outlines_.size(); ++n) {
      outlines_[n].start = place.transform(outlines_[n].start);
      for (OutlinePiece& piece : outlines_[n].pieces) {
        for (Vec2d& p : piece.control) p = place.transform(p);
      }
      pieces_ += outlines_[n].pieces.size();
    }
    if (pieces_ <= kMaxPieces) return absl::OkStatus();
    return Error(node, "exceeds the limit of ", kMaxPieces, " lines and curves, uses included");
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
  ForeignElements foreign_;
  absl::flat_hash_map<absl::string_view, pugi::xml_node> ids_;  // of the document
  std::vector<Outline> outlines_;
  size_t elements_ = 0, pieces_ = 0;  // so far
};

}  // namespace

absl::StatusOr<std::vector<Polyline>> ParseSvg(absl::string_view text) {
  const absl::StatusOr<std::string> expanded = ExpandEntities(text);
  if (!expanded.ok()) return expanded.status();
  return SvgReader(*expanded).Read();
}

}  // namespace latvox::client
