// Lengths of SVG and CSS.
#ifndef LATVOX_CLIENT_TOOL_CURVE_SVG_LENGTH_H_
#define LATVOX_CLIENT_TOOL_CURVE_SVG_LENGTH_H_

#include <optional>
#include <pugixml.hpp>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace latvox::client {

// The box that percentages refer to, in user units. Absent: the drawing does not tell.
struct Viewport {
  std::optional<double> width, height;
};

// The direction that a percentage of the viewport refers to.
enum class Along { kX, kY, kBoth };

// Reads a length in user units, 96 to an inch: a number with a unit or without, or calc(), min(), max() or clamp() of
// such. Errors: INVALID_ARGUMENT, with the reason to add to the text: no finite number, a unit of fonts or windows, or
// an unknown one; a percentage of an absent viewport.
absl::StatusOr<double> ParseLength(absl::string_view text, Along along, const Viewport& viewport);

// CSS demands a unit where attributes do not. Error: INVALID_ARGUMENT with the reason, for a number other than 0
// without one. The text may still be no length.
absl::Status CheckUnit(absl::string_view text);

// Reads an attribute; leaves `value` if the element lacks it. Errors: those of ParseLength, naming the attribute.
absl::Status ReadLength(const pugi::xml_node& node, const char* name, Along along, const Viewport& viewport,
                        double& value);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CURVE_SVG_LENGTH_H_
