// The surroundings of a picture's voxels: background, legend and scale bar.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_PICTURE_STYLE_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_PICTURE_STYLE_H_

#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "client/tool/output/image.h"
#include "client/tool/output/legend.h"

namespace latvox::client {

struct PictureStyle {
  std::optional<Rgb8> background = Rgb8{248, 248, 246};  // absent: transparent
  std::optional<Legend> legend = std::nullopt;           // also with a scale bar, even without any entry
};

// Returns the bytes of a PNG file: the picture before the background, and above its legend.
//   scale   pixels per unit of the world
// Errors: INTERNAL (libpng).
absl::StatusOr<std::string> FinishPicture(const Image& picture, double scale, const PictureStyle& style);

// Returns the length of a scale bar: 1, 2 or 5 times a power of ten, as long as possible but at most `most`.
double BarLength(double most);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_PICTURE_STYLE_H_
