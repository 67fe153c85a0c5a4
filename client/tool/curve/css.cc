#include "client/tool/curve/css.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "client/tool/curve/scan.h"

namespace latvox::client {
namespace {

constexpr absl::string_view kLengthProperties[] = {"x", "y", "width", "height", "cx", "cy", "r", "rx", "ry"};
constexpr absl::string_view kOthers[] = {"d",       "transform", "transform-origin", "transform-box",
                                         "display", "visibility"};

// Properties that move or resize elements, and that this reader does not have.
constexpr absl::string_view kRefused[] = {"all", "translate", "rotate", "scale", "zoom", "offset", "offset-path"};

// At-rules that neither place nor hide an element of a drawing that stands still.
constexpr absl::string_view kSilentAtRules[] = {"@charset",           "@font-face",     "@keyframes",
                                                "@-webkit-keyframes", "@page",          "@property",
                                                "@counter-style",     "@color-profile", "@font-feature-values"};

template <class List>
bool Has(const List& list, absl::string_view word) {
  return std::find(std::begin(list), std::end(list), word) != std::end(list);
}

absl::string_view Trimmed(absl::string_view text) { return absl::StripAsciiWhitespace(text); }

// Returns the beginning of a rule or declaration, for messages.
std::string Beginning(absl::string_view text) {
  constexpr size_t kMost = 60;
  text = Trimmed(text);
  return text.size() > kMost ? absl::StrCat(text.substr(0, kMost), "...") : std::string(text);
}

template <class... Parts>
absl::Status Bad(absl::string_view rule, const Parts&... parts) {
  return absl::InvalidArgumentError(absl::StrCat("has the style \"", Beginning(rule), "\", ", parts...));
}

// Returns the place behind a string that begins at `at`.
size_t BehindString(absl::string_view css, size_t at) {
  const char quote = css[at];
  for (++at; at < css.size() && css[at] != quote; ++at) {
    if (css[at] == '\\') ++at;
  }
  return std::min(at + 1, css.size());
}

std::string WithoutComments(absl::string_view css) {
  std::string text;
  for (size_t at = 0; at < css.size();) {
    if (absl::StartsWith(css.substr(at), "/*")) {
      const size_t end = css.find("*/", at + 2);
      at = end == absl::string_view::npos ? css.size() : end + 2;
      text += ' ';
      continue;
    }
    const size_t end = css[at] == '"' || css[at] == '\'' ? BehindString(css, at) : at + 1;
    absl::StrAppend(&text, css.substr(at, end - at));
    at = end;
  }
  return text;
}

// Returns the place of the first of these characters that is in no string and no brackets, or the end.
size_t FindOutside(absl::string_view css, absl::string_view stops) {
  size_t depth = 0;
  for (size_t at = 0; at < css.size();) {
    const char c = css[at];
    if (depth == 0 && absl::StrContains(stops, c)) return at;
    if (c == '"' || c == '\'') {
      at = BehindString(css, at);
      continue;
    }
    if (c == '(' || c == '[' || c == '{') ++depth;
    if ((c == ')' || c == ']' || c == '}') && depth > 0) --depth;
    ++at;
  }
  return css.size();
}

// Removes what is before the first of these characters, with this character, and returns it.
absl::string_view Take(absl::string_view& rest, absl::string_view stops, char* stop = nullptr) {
  const size_t end = FindOutside(rest, stops);
  const absl::string_view taken = rest.substr(0, end);
  if (stop != nullptr) *stop = end < rest.size() ? rest[end] : '\0';
  rest.remove_prefix(std::min(end + 1, rest.size()));
  return taken;
}

// Returns whether the value is a number other than 0 and has no unit.
bool LacksUnit(absl::string_view value) {
  double number = 0;
  absl::string_view rest = Trimmed(value);
  return ReadDecimal(rest, number) && rest.empty() && number != 0;
}

bool TransformLacksUnit(absl::string_view value) {
  while (!value.empty()) {
    const std::string name = absl::AsciiStrToLower(Trimmed(Take(value, "(")));
    if (value.empty()) return false;
    const bool has_units =
        absl::StartsWith(name, "translate") || absl::StartsWith(name, "rotate") || absl::StartsWith(name, "skew");
    for (const absl::string_view argument : absl::StrSplit(Take(value, ")"), ',')) {
      if (has_units && LacksUnit(argument)) return true;
    }
  }
  return false;
}

bool OriginLacksUnit(absl::string_view value) {
  for (const absl::string_view word : absl::StrSplit(value, absl::ByAnyChar(" \t\r\n\f"))) {
    if (LacksUnit(word)) return true;
  }
  return false;
}

// Returns whether one of the properties kRefused has no effect. `offset` of a gradient's stop has a number.
bool IsNeutral(absl::string_view name, absl::string_view value) {
  if (name == "offset" && !absl::StrContains(value, '(')) return true;
  return Has(std::initializer_list<absl::string_view>{"none", "normal", "1"}, value);
}

// Turns path("M...") into its data. Returns nothing for another value.
std::optional<std::string> PathDataOf(absl::string_view value) {
  if (absl::EqualsIgnoreCase(value, "none")) return "";
  if (!absl::StartsWithIgnoreCase(value, "path(") || !absl::EndsWith(value, ")")) return std::nullopt;
  value = Trimmed(value.substr(5, value.size() - 6));
  if (value.size() < 2 || (value[0] != '"' && value[0] != '\'') || value.back() != value[0]) return std::nullopt;
  value = value.substr(1, value.size() - 2);
  return absl::StrContains(value, '\\') ? std::nullopt : std::optional(std::string(value));
}

absl::Status CheckValue(absl::string_view rule, CssDeclaration& declaration) {
  const std::string lower = absl::AsciiStrToLower(declaration.value);
  for (const absl::string_view function : {"var(", "attr(", "env("}) {
    if (absl::StrContains(lower, function)) return Bad(rule, "and ", function, ") is not read");
  }
  if (Has(std::initializer_list<absl::string_view>{"revert", "revert-layer"}, lower) ||
      (lower == "inherit" && declaration.name != "visibility")) {
    return Bad(rule, "and the keyword ", lower, " is not read");
  }
  const bool lacks_unit = Has(kLengthProperties, declaration.name) ? LacksUnit(lower)
                          : declaration.name == "transform"
                              ? TransformLacksUnit(lower)
                              : declaration.name == "transform-origin" && OriginLacksUnit(lower);
  if (lacks_unit) return Bad(rule, "and CSS demands a unit, such as px or deg");
  if (declaration.name != "d" || lower == "initial" || lower == "unset") return absl::OkStatus();
  auto data = PathDataOf(declaration.value);
  if (!data) return Bad(rule, "which is not none or path(\"DATA\")");
  declaration.value = *std::move(data);
  return absl::OkStatus();
}

bool IsIdentifier(char c) {
  return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_' ||
         static_cast<unsigned char>(c) > 127;
}

std::string TakeIdentifier(absl::string_view& rest) {
  size_t end = 0;
  while (end < rest.size() && IsIdentifier(rest[end])) ++end;
  const std::string taken(rest.substr(0, end));
  rest.remove_prefix(end);
  return taken;
}

// Returns nothing for a selector with anything but one type, classes and one ID.
std::optional<CssSelector> ParseSelector(absl::string_view rest) {
  if (rest.empty()) return std::nullopt;
  CssSelector selector;
  if (!absl::ConsumePrefix(&rest, "*")) selector.type = TakeIdentifier(rest);
  while (!rest.empty()) {
    const char kind = rest[0];
    rest.remove_prefix(1);
    std::string name = TakeIdentifier(rest);
    if (name.empty() || (kind != '.' && kind != '#') || (kind == '#' && !selector.id.empty())) return std::nullopt;
    if (kind == '#') selector.id = std::move(name);
    if (kind == '.') selector.classes.push_back(std::move(name));
  }
  return selector;
}

// Returns whether a selector matches only while a pointer or keyboard acts on an element.
bool WaitsForPeople(absl::string_view selector) {
  return !absl::StrContains(selector, ":not(") &&
         (absl::StrContains(selector, ":hover") || absl::StrContains(selector, ":active") ||
          absl::StrContains(selector, ":focus"));
}

class SheetReader {
 public:
  absl::Status Read(absl::string_view rest, bool is_certain) {
    while (!Trimmed(rest).empty()) {
      char stop = '\0';
      const absl::string_view prelude = Trimmed(Take(rest, absl::StartsWith(Trimmed(rest), "@") ? "{;" : "{", &stop));
      const absl::string_view block = stop == '{' ? Take(rest, "}") : absl::string_view();
      const auto status = absl::StartsWith(prelude, "@") ? ReadAtRule(prelude, block, stop == '{')
                                                         : ReadRule(prelude, block, is_certain);
      if (!status.ok()) return status;
    }
    return absl::OkStatus();
  }

  std::vector<CssRule> rules;

 private:
  absl::Status ReadAtRule(absl::string_view prelude, absl::string_view block, bool has_block) {
    const std::string name = absl::AsciiStrToLower(prelude.substr(0, prelude.find_first_of(" \t\r\n\f\"'(")));
    if (Has(kSilentAtRules, name)) return absl::OkStatus();
    if (name == "@namespace" && absl::StrContains(prelude, "http://www.w3.org/2000/svg")) return absl::OkStatus();
    if (!has_block) return Bad(prelude, "and this rule is not read");
    if (++depth_ > kMaxDepth) return Bad(prelude, "nested ", depth_, " levels deep; the limit is ", kMaxDepth);
    const auto status = Read(block, /*is_certain=*/false);
    --depth_;
    return status;
  }

  absl::Status ReadRule(absl::string_view prelude, absl::string_view block, bool is_certain) {
    if (FindOutside(block, "{") < block.size()) return Bad(prelude, "and nested rules are not read");
    auto declarations = ParseDeclarations(block);
    if (!declarations.ok()) return declarations.status();
    if (declarations->empty()) return absl::OkStatus();
    CssRule rule{{}, *std::move(declarations)};
    absl::string_view rest = prelude;
    for (char stop = ','; stop == ',';) {
      const absl::string_view text = Trimmed(Take(rest, ",", &stop));
      if (WaitsForPeople(text)) continue;
      auto selector = ParseSelector(text);
      if (!selector) {
        return Bad(prelude, "and only selectors of a type, classes and an ID are read, and lists of them, not \"",
                   Beginning(text), "\"");
      }
      rule.selectors.push_back(*std::move(selector));
    }
    if (rule.selectors.empty()) return absl::OkStatus();
    if (!is_certain) return Bad(prelude, "and rules that apply under a condition are not read");
    rules.push_back(std::move(rule));
    return absl::OkStatus();
  }

  static constexpr int kMaxDepth = 32;
  int depth_ = 0;  // of at-rules
};

}  // namespace

absl::StatusOr<std::vector<CssDeclaration>> ParseDeclarations(absl::string_view css) {
  const std::string text = WithoutComments(css);
  std::vector<CssDeclaration> declarations;
  for (absl::string_view rest = text; !rest.empty();) {
    const absl::string_view rule = Take(rest, ";");
    absl::string_view value = rule;
    std::string name = absl::AsciiStrToLower(Trimmed(Take(value, ":")));
    if (absl::StartsWith(name, "-webkit-transform")) name = name.substr(8);
    CssDeclaration declaration{name, std::string(Trimmed(value))};
    if (const size_t mark = declaration.value.rfind('!'); mark != std::string::npos) {
      declaration.is_important = absl::EqualsIgnoreCase(Trimmed(declaration.value.substr(mark + 1)), "important");
      if (declaration.is_important) declaration.value = std::string(Trimmed(declaration.value.substr(0, mark)));
    }
    if (Has(kRefused, name) && !IsNeutral(name, absl::AsciiStrToLower(declaration.value))) {
      return Bad(rule, "and the property ", name, " is not read");
    }
    if (!Has(kLengthProperties, name) && !Has(kOthers, name)) continue;
    if (auto status = CheckValue(rule, declaration); !status.ok()) return status;
    declarations.push_back(std::move(declaration));
  }
  return declarations;
}

absl::StatusOr<std::vector<CssRule>> ParseStyleSheet(absl::string_view css, bool is_certain) {
  SheetReader reader;
  if (auto status = reader.Read(WithoutComments(css), is_certain); !status.ok()) return status;
  return std::move(reader.rules);
}

}  // namespace latvox::client
