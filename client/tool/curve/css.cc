#include "client/tool/curve/css.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "client/tool/curve/scan.h"
#include "client/tool/curve/svg_length.h"
#include "client/tool/curve/svg_transform.h"

namespace latvox::client {
namespace {

constexpr absl::string_view kLengthProperties[] = {"x", "y", "width", "height", "cx", "cy", "r", "rx", "ry"};
constexpr absl::string_view kOthers[] = {"d",       "transform", "transform-origin", "transform-box",
                                         "display", "visibility"};

// Values of display and visibility that are read. Browsers drop unknown ones, and what was before counts.
constexpr absl::string_view kDisplays[] = {
    "none", "initial",     "unset", "inline",      "block", "inline-block", "flow-root", "list-item",
    "flex", "inline-flex", "grid",  "inline-grid", "table", "inline-table", "table-row", "table-cell"};
constexpr absl::string_view kVisibilities[] = {"visible", "hidden", "collapse", "initial", "unset", "inherit"};

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

bool IsIdentifier(char c) {
  return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_' ||
         static_cast<unsigned char>(c) > 127;
}

// Returns the place behind the string, the URL without quotes, the escape or the character that begins at `at`.
size_t BehindToken(absl::string_view css, size_t at) {
  if (css[at] == '"' || css[at] == '\'') return BehindString(css, at);
  if (css[at] == '\\') return std::min(at + 2, css.size());
  const bool begins = at == 0 || !IsIdentifier(css[at - 1]);
  if (!begins || !absl::StartsWithIgnoreCase(css.substr(at), "url(")) return at + 1;
  size_t end = css.find_first_not_of(" \t\r\n\f", at + 4);
  if (end < css.size() && (css[end] == '"' || css[end] == '\'')) return at + 1;
  while (end < css.size() && css[end] != ')') end += css[end] == '\\' ? 2 : 1;
  return end < css.size() ? end + 1 : css.size();
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
    const size_t end = BehindToken(css, at);
    absl::StrAppend(&text, css.substr(at, end - at));
    at = end;
  }
  return text;
}

// Returns the place of the first of these characters that is in no string, URL or brackets, or the end.
size_t FindOutside(absl::string_view css, absl::string_view stops) {
  size_t depth = 0;
  for (size_t at = 0; at < css.size(); at = BehindToken(css, at)) {
    const char c = css[at];
    if (depth == 0 && absl::StrContains(stops, c)) return at;
    if (c == '(' || c == '[' || c == '{') ++depth;
    if ((c == ')' || c == ']' || c == '}') && depth > 0) --depth;
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

// Checks what CSS demands beyond what attributes do.
absl::Status CheckGrammar(absl::string_view name, absl::string_view value) {
  if (value.empty()) return absl::InvalidArgumentError("which has no value");
  if ((name == "display" && !Has(kDisplays, value)) || (name == "visibility" && !Has(kVisibilities, value))) {
    return absl::InvalidArgumentError(absl::StrCat("and this value of ", name, " is not read"));
  }
  if (Has(kLengthProperties, name)) return CheckUnit(value);
  if (name == "transform") return CheckCssTransforms(value);
  return name == "transform-origin" ? CheckCssOrigin(value) : absl::OkStatus();
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
  if (auto status = CheckGrammar(declaration.name, lower); !status.ok()) return Bad(rule, status.message());
  if (declaration.name != "d" || lower == "initial" || lower == "unset") return absl::OkStatus();
  auto data = PathDataOf(declaration.value);
  if (!data) return Bad(rule, "which is not none or path(\"DATA\")");
  declaration.value = *std::move(data);
  return absl::OkStatus();
}

// Returns nothing if the text begins with no identifier. A digit begins none, also behind a hyphen.
std::string TakeIdentifier(absl::string_view& rest) {
  const size_t first = absl::StartsWith(rest, "-") ? 1 : 0;
  if (first == rest.size() || !IsIdentifier(rest[first])) return "";
  if (absl::ascii_isdigit(static_cast<unsigned char>(rest[first]))) return "";
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

// Returns whether a selector matches only while a pointer or keyboard acts on an element. Within brackets and behind a
// backslash, these words may mean something else.
bool WaitsForPeople(absl::string_view selector) {
  return selector.find_first_of("([\\") == absl::string_view::npos &&
         (absl::StrContains(selector, ":hover") || absl::StrContains(selector, ":active") ||
          absl::StrContains(selector, ":focus"));
}

// Returns the selectors of a list that do not wait.
std::vector<absl::string_view> LastingSelectors(absl::string_view list) {
  std::vector<absl::string_view> selectors;
  for (char stop = ','; stop == ',';) {
    const absl::string_view text = Trimmed(Take(list, ",", &stop));
    if (!WaitsForPeople(text)) selectors.push_back(text);
  }
  return selectors;
}

// The value of a custom property may have braces.
bool HasNestedRules(absl::string_view block) {
  while (!block.empty()) {
    const absl::string_view part = Trimmed(Take(block, ";"));
    if (!absl::StartsWith(part, "--") && FindOutside(part, "{") < part.size()) return true;
  }
  return false;
}

class SheetReader {
 public:
  absl::Status Read(absl::string_view rest, bool is_certain) {
    for (SkipSpace(rest); !rest.empty(); SkipSpace(rest)) {
      char stop = '\0';
      const absl::string_view prelude = Trimmed(Take(rest, rest[0] == '@' ? "{;" : "{", &stop));
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
    const std::vector<absl::string_view> selectors = LastingSelectors(prelude);
    if (selectors.empty()) return absl::OkStatus();
    if (HasNestedRules(block)) return Bad(prelude, "and nested rules are not read");
    auto declarations = ParseDeclarations(block);
    if (!declarations.ok()) return declarations.status();
    if (declarations->empty()) return absl::OkStatus();
    CssRule rule{{}, *std::move(declarations)};
    for (const absl::string_view text : selectors) {
      auto selector = ParseSelector(text);
      if (!selector) {
        return Bad(prelude, "and only selectors of a type, classes and an ID are read, and lists of them, not \"",
                   Beginning(text), "\"");
      }
      rule.selectors.push_back(*std::move(selector));
    }
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
