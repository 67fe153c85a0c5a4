// Drawings: files of polylines.
#ifndef LATVOX_CLIENT_TOOL_CURVE_CURVE_FILE_H_
#define LATVOX_CLIENT_TOOL_CURVE_CURVE_FILE_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "latvox/plane_types.h"

namespace latvox::client {

struct Drawing {
  std::vector<Polyline> polylines;  // at least one, each with points
  bool y_down = false;              // y points down in the drawing
};

// Reads .txt (client/tool/curve/text_curves.h), .svg (client/tool/curve/svg_curves.h), or standard input for "-", which
// is .svg if it begins with "<".
// Errors, with the path: as ReadBytes; INVALID_ARGUMENT: another extension, damaged, not supported, no curve at all.
absl::StatusOr<Drawing> ReadCurveFile(const std::string& path);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CURVE_CURVE_FILE_H_
