// Names of elements and attributes, whatever prefixes a drawing gives to namespaces.
#ifndef LATVOX_CLIENT_TOOL_CURVE_SVG_NAMES_H_
#define LATVOX_CLIENT_TOOL_CURVE_SVG_NAMES_H_

#include <pugixml.hpp>

namespace latvox::client {

inline constexpr char kSvgNamespace[] = "http://www.w3.org/2000/svg";

// Removes the prefix of SVG's elements, and gives the attributes of XLink the prefix "xlink:". Elements of other
// namespaces get or keep a prefix, which may be empty: a colon tells them apart. Two things need no declaration: the
// prefix "svg", and the namespace of elements without a prefix.
void ResolveNames(pugi::xml_document& document);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CURVE_SVG_NAMES_H_
