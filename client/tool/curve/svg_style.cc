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

constexpr size_t kMaxSteps = 10'000'000;

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
      entries_[key].push_back({std::move(selector), declarations_.size()});
    }
    declarations_.push_back(std::move(rule.declarations));
  }
  return absl::OkStatus();
}

absl::Status SvgStyles::Apply(pugi::xml_node node, absl::string_view type) {
  std::vector<absl::string_view> classes = absl::StrSplit(absl::string_view(node.attribute("class").value()),
                                                          absl::ByAnyChar(" \t\r\n\f"), absl::SkipEmpty());
  std::sort(classes.begin(), classes.end());
  classes.erase(std::unique(classes.begin(), classes.end()), classes.end());
  const absl::string_view id = node.attribute("id").value();
  std::vector<std::string> keys = {"", std::string(type), absl::StrCat("#", id)};
  for (const absl::string_view each : classes) keys.push_back(absl::StrCat(".", each));

  const auto matches = [&](const CssSelector& selector) {
    return (selector.type.empty() || selector.type == type) && (selector.id.empty() || selector.id == id) &&
           std::all_of(selector.classes.begin(), selector.classes.end(), [&](const std::string& wanted) {
             return std::binary_search(classes.begin(), classes.end(), wanted);
           });
  };
  const auto own = ParseDeclarations(node.attribute("style").value());
  if (!own.ok()) return own.status();

  // The last one wins: by importance, the attribute `style` above sheets, specificity, order.
  using Rank = std::tuple<bool, bool, std::array<size_t, 3>, size_t>;
  absl::flat_hash_map<absl::string_view, std::pair<Rank, const CssDeclaration*>> winners;  // by property
  const auto offer = [&](const CssDeclaration& declaration, const Rank& rank) {
    auto& winner = winners[declaration.name];
    if (winner.second == nullptr || winner.first <= rank) winner = {rank, &declaration};
  };
  for (const std::string& key : keys) {
    const auto found = entries_.find(key);
    if (found == entries_.end()) continue;
    for (const auto& [selector, rule] : found->second) {
      const bool is_match = matches(selector);
      steps_ += 1 + selector.classes.size() + (is_match ? declarations_[rule].size() : 0);
      if (steps_ > kMaxSteps) {
        return absl::InvalidArgumentError(
            absl::StrCat("exceeds the limit of ", kMaxSteps, " selectors and declarations to compare with elements"));
      }
      if (!is_match) continue;
      for (const CssDeclaration& each : declarations_[rule]) {
        offer(each, {each.is_important, false, selector.specificity(), rule});
      }
    }
  }
  for (const CssDeclaration& each : *own) offer(each, {each.is_important, true, {}, 0});
  for (const auto& [name, winner] : winners) Write(node, *winner.second);
  RemoveAutoSizes(node);
  return absl::OkStatus();
}

}  // namespace latvox::client
