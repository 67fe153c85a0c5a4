// The XML of 3MF.
#ifndef LATVOX_CLIENT_MESH_FILES_THREE_MF_PART_H_
#define LATVOX_CLIENT_MESH_FILES_THREE_MF_PART_H_

#include <algorithm>
#include <cstddef>
#include <memory>
#include <pugixml.hpp>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"

namespace latvox::client {

// Returns the name without the prefix of its namespace. No two names that are read here differ only in their prefix.
inline absl::string_view LocalName(absl::string_view name) { return name.substr(name.find(':') + 1); }

inline pugi::xml_attribute AttributeOf(const pugi::xml_node& node, absl::string_view name) {
  return node.find_attribute([name](const pugi::xml_attribute& a) { return LocalName(a.name()) == name; });
}

// Returns the value without white space around it, which numbers and names of 3MF may have.
inline absl::string_view TextOf(const pugi::xml_attribute& attribute) {
  return absl::StripAsciiWhitespace(attribute.value());
}

inline pugi::xml_node Child(const pugi::xml_node& node, absl::string_view name) {
  return node.find_child([name](const pugi::xml_node& child) { return LocalName(child.name()) == name; });
}

// One file of the archive. Parsing changes the text, so line ends are counted before.
class ThreeMfPart {
 public:
  // `text` is UTF-8 or UTF-16. Errors: INVALID_ARGUMENT, with name and line.
  static absl::StatusOr<std::unique_ptr<ThreeMfPart>> Parse(std::string name, std::string text);

  pugi::xml_node root() const { return document_.document_element(); }
  const std::string& name() const { return name_; }

  // Returns an error in a node, with name, line and element.
  template <class... Words>
  absl::Status Error(const pugi::xml_node& node, const Words&... words) const {
    return ErrorAt(node.offset_debug(), "<", node.name(), ">: ", words...);
  }

 private:
  template <class... Words>
  absl::Status ErrorAt(std::ptrdiff_t offset, const Words&... words) const {
    const auto end = std::lower_bound(line_ends_.begin(), line_ends_.end(),
                                      static_cast<size_t>(std::max<std::ptrdiff_t>(offset, 0)));
    return absl::InvalidArgumentError(absl::StrCat(name_, ", line ", end - line_ends_.begin() + 1, ": ", words...));
  }

  std::string name_, text_;
  std::vector<size_t> line_ends_;
  pugi::xml_document document_;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_THREE_MF_PART_H_
