// The part of CSS that places and hides elements of a drawing.
#ifndef LATVOX_CLIENT_TOOL_CURVE_CSS_H_
#define LATVOX_CLIENT_TOOL_CURVE_CSS_H_

#include <array>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace latvox::client {

// A declaration that matters: of a geometry property of SVG 2 (x, y, width, height, cx, cy, r, rx, ry, d), transform,
// transform-origin, transform-box, display or visibility.
struct CssDeclaration {
  std::string name, value;  // the value of d is the path data
  bool is_important = false;
};

// An element matches if it has all of these. An empty type or ID matches every element.
struct CssSelector {
  std::string type, id;
  std::vector<std::string> classes;

  // A greater specificity wins: IDs count first, then classes, then types.
  std::array<size_t, 3> specificity() const {
    return {id.empty() ? size_t{0} : size_t{1}, classes.size(), type.empty() ? size_t{0} : size_t{1}};
  }
};

struct CssRule {
  std::vector<CssSelector> selectors;
  std::vector<CssDeclaration> declarations;
};

// Reads declarations, such as those of an attribute `style`, and leaves out those that do not matter. Errors:
// INVALID_ARGUMENT naming the declaration. It has no value; lacks a unit or a comma, or has one comma too many; has
// var(), attr() or env(); takes its value from elsewhere by a keyword; or has an unknown display or visibility. Or it
// has another property that moves elements, such as `rotate`.
absl::StatusOr<std::vector<CssDeclaration>> ParseDeclarations(absl::string_view css);

// Reads a style sheet, and leaves out rules that do not matter. These are rules without a declaration that does, and
// rules that wait for a pointer or keyboard, such as :hover. Animations and fonts do not matter. Errors:
// INVALID_ARGUMENT naming the rule: a declaration, as above; a selector other than lists of types, classes and IDs;
// another at-rule; nested rules.
//   is_certain   whether the sheet applies; if not, any rule that matters is refused
absl::StatusOr<std::vector<CssRule>> ParseStyleSheet(absl::string_view css, bool is_certain);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CURVE_CSS_H_
