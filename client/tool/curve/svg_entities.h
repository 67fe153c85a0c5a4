// The entities that a drawing declares for itself. Programs use them for namespaces and styles.
#ifndef LATVOX_CLIENT_TOOL_CURVE_SVG_ENTITIES_H_
#define LATVOX_CLIENT_TOOL_CURVE_SVG_ENTITIES_H_

#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace latvox::client {

// Replaces the entities in a document by the texts that it declares for them. Other names, and a document that is not
// XML, stay as they are. Errors: INVALID_ARGUMENT with the line of the use, for a text in another file, for a parameter
// entity, and beyond limits of depth, number and bytes.
absl::StatusOr<std::string> ExpandEntities(absl::string_view xml);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CURVE_SVG_ENTITIES_H_
