#include "client/tool/curve/svg_style.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"

namespace latvox::client {
namespace {

bool IsOneOf(absl::string_view word, std::initializer_list<absl::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

void Write(pugi::xml_node& node, const CssDeclaration& declaration) {
  const char* const name = declaration.name.c_str();
  const std::string keyword = absl::AsciiStrToLower(declaration.value);
  if (IsOneOf(keyword, {"initial", "unset", "inherit"})) {  // the parser refuses those that take a value from elsewhere
    node.remove_attribute(name);
    if (keyword == "initial" && declaration.name == "visibility") node.append_attribute(name) = "visible";
    return;
  }
  if (!node.attribute(name)) node.append_attribute(name);
  node.attribute(name) = declaration.value.c_str();
}

// A size of "auto" is the default of its element.
void RemoveAutoSizes(pugi::xml_node& node) {
  for (const char* const name : {"width", "height"}) {
    if (absl::EqualsIgnoreCase(absl::StripAsciiWhitespace(node.attribute(name).value()), "auto")) {
      node.remove_attribute(name);
    }
  }
}

}  // namespace

absl::Status SvgStyles::AddSheet(const pugi::xml_node& style) {
  const absl::string_view type = style.attribute("type").value();
  if (!type.empty() && !absl::EqualsIgnoreCase(type, "text/css")) return absl::OkStatus();
  std::string css;
  for (const pugi::xml_node& child : style.children()) css += child.value();
  const std::string media = absl::AsciiStrToLower(absl::StripAsciiWhitespace(style.attribute("media").value()));
  auto rules = ParseStyleSheet(css, /*is_certain=*/IsOneOf(media, {"", "all", "screen"}));
  if (!rules.ok()) return rules.status();
  for (CssRule& rule : *rules) {
    for (CssSelector& selector : rule.selectors) {
      const std::string key = !selector.id.empty()        ? absl::StrCat("#", selector.id)
                              : !selector.classes.empty() ? absl::StrCat(".", selector.classes[0])
                                                          : selector.type;
      entries_[key].push_back({std::move(selector), rule.declarations, rules_});
    }
    ++rules_;
  }
  return absl::OkStatus();
}

absl::Status SvgStyles::Apply(pugi::xml_node node, absl::string_view type) const {
  const std::vector<absl::string_view> classes = absl::StrSplit(absl::string_view(node.attribute("class").value()),
                                                                absl::ByAnyChar(" \t\r\n\f"), absl::SkipEmpty());
  const absl::string_view id = node.attribute("id").value();
  std::vector<std::string> keys = {"", std::string(type), absl::StrCat("#", id)};
  for (const absl::string_view each : classes) keys.push_back(absl::StrCat(".", each));

  const auto matches = [&](const CssSelector& selector) {
    return (selector.type.empty() || selector.type == type) && (selector.id.empty() || selector.id == id) &&
           std::all_of(selector.classes.begin(), selector.classes.end(), [&](const std::string& wanted) {
             return std::find(classes.begin(), classes.end(), wanted) != classes.end();
           });
  };
  const auto own = ParseDeclarations(node.attribute("style").value());
  if (!own.ok()) return own.status();

  // The last one wins: by importance, the attribute `style` above sheets, specificity, order.
  using Rank = std::tuple<bool, bool, std::array<size_t, 3>, size_t>;
  std::vector<std::pair<Rank, const CssDeclaration*>> ranked;
  for (const std::string& key : keys) {
    const auto found = entries_.find(key);
    if (found == entries_.end()) continue;
    for (const Entry& entry : found->second) {
      if (!matches(entry.selector)) continue;
      for (const CssDeclaration& each : entry.declarations) {
        ranked.push_back({{each.is_important, false, entry.selector.specificity(), entry.order}, &each});
      }
    }
  }
  for (const CssDeclaration& each : *own) ranked.push_back({{each.is_important, true, {}, 0}, &each});
  std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [rank, declaration] : ranked) Write(node, *declaration);
  RemoveAutoSizes(node);
  return absl::OkStatus();
}

}  // namespace latvox::client
