// The cascade: which value of a property an element of a drawing has.
#ifndef LATVOX_CLIENT_TOOL_CURVE_SVG_STYLE_H_
#define LATVOX_CLIENT_TOOL_CURVE_SVG_STYLE_H_

#include <array>
#include <pugixml.hpp>
#include <string>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "client/tool/curve/css.h"

namespace latvox::client {

// The style sheets of a drawing. Not thread-safe.
class SvgStyles {
 public:
  // Adds the sheet of an element `style`, behind those before. Errors: those of ParseStyleSheet.
  absl::Status AddSheet(const pugi::xml_node& style);

  // Writes the values of sheets and of the attribute `style` into the attributes of the same names, because these mean
  // the same. Errors: those of ParseDeclarations; more than ten million selectors and declarations to compare with the
  // elements so far.
  //   type   of the element, without a prefix
  absl::Status Apply(pugi::xml_node node, absl::string_view type);

 private:
  struct Entry {
    CssSelector selector;
    size_t rule;  // in declarations_
  };

  // Entries by the ID of their selector, else by its first class, else by its type, as "#id", ".class", "type".
  absl::flat_hash_map<std::string, std::vector<Entry>> entries_;
  std::vector<std::vector<CssDeclaration>> declarations_;  // of each rule, in the order of the sheets
  size_t steps_ = 0;                                       // selectors, classes and declarations looked at so far
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CURVE_SVG_STYLE_H_
