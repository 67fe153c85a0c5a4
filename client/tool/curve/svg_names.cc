#include "client/tool/curve/svg_names.h"

#include <string>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"

namespace latvox::client {
namespace {

constexpr char kXlinkNamespace[] = "http://www.w3.org/1999/xlink";

// Returns the prefix and the local name.
std::pair<absl::string_view, absl::string_view> Split(absl::string_view name) {
  const size_t colon = name.find(':');
  if (colon == absl::string_view::npos) return {"", name};
  return {name.substr(0, colon), name.substr(colon + 1)};
}

// Declarations of namespaces hold for an element and all within it.
class NameWalker : public pugi::xml_tree_walker {
 public:
  bool for_each(pugi::xml_node& node) override {
    while (!declared_.empty() && declared_.back().depth >= depth()) {
      spaces_[declared_.back().prefix].pop_back();
      declared_.pop_back();
    }
    if (node.type() != pugi::node_element) return true;
    for (const pugi::xml_attribute& attribute : node.attributes()) {
      const auto [prefix, local] = Split(attribute.name());
      if (prefix == "xmlns") Declare(local, attribute.value());
      if (prefix.empty() && local == "xmlns") Declare("", attribute.value());
    }
    Resolve(node);
    return true;
  }

  ForeignElements TakeForeign() { return std::move(foreign_); }

 private:
  struct Declared {
    int depth;
    std::string prefix;
  };

  void Declare(absl::string_view prefix, absl::string_view space) {
    declared_.push_back({depth(), std::string(prefix)});
    spaces_[prefix].emplace_back(space);
  }

  // Returns "" if nothing is declared.
  absl::string_view SpaceOf(absl::string_view prefix) const {
    const auto found = spaces_.find(prefix);
    return found == spaces_.end() || found->second.empty() ? absl::string_view() : found->second.back();
  }

  void Resolve(pugi::xml_node& node) {
    const std::string name = node.name();
    const auto [prefix, local] = Split(name);
    const absl::string_view space = SpaceOf(prefix);
    const bool is_svg = space.empty() ? prefix.empty() || prefix == "svg" : space == kSvgNamespace;
    if (!is_svg) foreign_.insert(node.internal_object());
    // A shorter name stays in its place, which tells the line of the element.
    if (is_svg && !prefix.empty()) node.set_name(std::string(local).c_str());
    for (pugi::xml_attribute attribute : node.attributes()) {
      const std::string full = attribute.name();
      const auto [of, what] = Split(full);
      if (of.empty() || of == "xlink" || SpaceOf(of) != kXlinkNamespace) continue;
      attribute.set_name(absl::StrCat("xlink:", what).c_str());
    }
  }

  ForeignElements foreign_;
  std::vector<Declared> declared_;                                     // by the node and those around it
  absl::flat_hash_map<std::string, std::vector<std::string>> spaces_;  // prefix -> what it stands for, the last counts
};

}  // namespace

ForeignElements ResolveNames(pugi::xml_document& document) {
  NameWalker walker;
  document.traverse(walker);
  return walker.TakeForeign();
}

}  // namespace latvox::client
