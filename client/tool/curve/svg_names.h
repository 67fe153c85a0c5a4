// Names of elements and attributes, whatever prefixes a drawing gives to namespaces.
#ifndef LATVOX_CLIENT_TOOL_CURVE_SVG_NAMES_H_
#define LATVOX_CLIENT_TOOL_CURVE_SVG_NAMES_H_

#include <pugixml.hpp>

#include "absl/container/flat_hash_set.h"

namespace latvox::client {

inline constexpr char kSvgNamespace[] = "http://www.w3.org/2000/svg";

// The elements of other namespaces, as xml_node::internal_object has them.
using ForeignElements = absl::flat_hash_set<const void*>;

// Removes the prefix of SVG's elements, and gives the attributes of XLink the prefix "xlink:". Two things need no
// declaration: the prefix "svg", and the namespace of elements without a prefix.
ForeignElements ResolveNames(pugi::xml_document& document);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CURVE_SVG_NAMES_H_
